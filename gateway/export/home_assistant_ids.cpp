// SPDX-License-Identifier: Apache-2.0
// What boards are called in Home Assistant, and which documents are of this bus.
#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "gateway/export/escaped_id.hpp"
#include "gateway/export/home_assistant.hpp"

namespace asip::gateway::exports {

using nlohmann::json;

// Ids may hold `A-Za-z0-9_-` only. Where a name holds something else, or two underscores, these stand with
// two hexadecimal digits in place of all but letters and digits: two names never become one.
std::string HomeAssistant::device_id(std::string_view board) const {
    const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    const bool exact =
        board.find("__") == std::string_view::npos &&
        std::all_of(board.begin(), board.end(), [&](char c) { return plain(c) || c == '-' || c == '_'; });
    return device_begin() + (exact ? std::string(board) : escaped_id(board, "__", plain));
}

std::string HomeAssistant::root_id() const {
    auto id = options_.root;
    std::replace_if(
        id.begin(), id.end(),
        [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-'; }, '_');
    return id;
}

std::string HomeAssistant::device_begin() const {
    return root_id() + "-";
}

std::string HomeAssistant::gateway_id() const {
    return root_id() + "_gateway";
}

std::string HomeAssistant::document_topic(std::string_view board) const {
    return options_.prefix + "/device/" + device_id(board) + "/config";
}

bool HomeAssistant::is_document(const std::string& topic, const std::string& place) const {
    constexpr std::string_view kEnd = "/config";
    const auto begin = place + "/device/" + device_begin();
    if (topic == place + "/device/" + gateway_id() + std::string(kEnd)) return true;
    return topic.starts_with(begin) && topic.ends_with(kEnd) &&
           topic.find('/', begin.size()) == topic.size() - kEnd.size();
}

std::vector<std::string> HomeAssistant::ours(const Retained& found, const std::string& place) const {
    auto result = below(base() + "/", found);
    // Another bus on this broker may have a root that begins as this one's does.
    const auto state = model::dump_json(json(gateway_state()));
    for (auto& topic : below(place + "/", found))
        if (is_document(topic, place) && found.at(topic).find(state) != std::string::npos)
            result.push_back(std::move(topic));
    return result;
}

}  // namespace asip::gateway::exports
