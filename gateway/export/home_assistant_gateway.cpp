// SPDX-License-Identifier: Apache-2.0
// The device of the gateway itself, whose entities are diagnostics.
#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/object_text.hpp"
#include "gateway/export/dialect.hpp"
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

bool HomeAssistant::is_ours(const Retained& found, const std::string& topic, const std::string& place) const {
    // Another bus on this broker may have a root that begins as this one's does.
    return topic.starts_with(base() + "/") ||
           (is_document(topic, place) &&
            found.at(topic).find(model::dump_json(json(gateway_state()))) != std::string::npos);
}

// It is loaded from the page or by asipctl.
void HomeAssistant::describe_firmware(ObjectText& components, const ExportedBoard& board) const {
    if (firmware_text(board).empty()) return;
    components.object(kFirmware)
        .add("p", "update")
        .add("uniq_id", device_id(board.board) + "_" + std::string(kFirmware))
        .add("name", "Firmware")
        .add("dev_cla", "firmware")
        .add("ent_cat", "diagnostic")
        .add("stat_t", firmware(board.board));
}

// A sketch that says no version is older than the first that did: it has 0.
std::string HomeAssistant::firmware_text(const ExportedBoard& board) const {
    if (board.version.empty() && board.available.empty()) return {};
    std::string text;
    ObjectText(text)
        .add("installed_version", board.version.empty() ? "0" : board.version)
        .add("latest_version", board.available.empty() ? board.version : board.available)
        .add("title", board.sketch);
    return text;
}

void HomeAssistant::describe_origin(ObjectText& document) const {
    auto origin = document.object("o");
    origin.add("name", "asip-gateway");
    if (!options_.version.empty()) origin.add("sw", options_.version);
}

std::string HomeAssistant::gateway_document(const std::vector<std::string>& /*boards*/,
                                            const std::string& /*on_bus*/) const {
    const auto id = gateway_id();
    std::string text;
    {
        ObjectText document(text);
        {
            auto device = document.object("dev");
            device.add_json("ids", "[\"" + id + "\"]").add("name", "ASIP gateway").add("mf", "ASIP");
            if (!options_.version.empty()) device.add("sw", options_.version);
            if (!options_.page.empty()) device.add("cu", options_.page);
        }
        describe_origin(document);
        auto all = document.object("cmps");
        const auto describe = [&id](ObjectText& component, const char* platform, const std::string& name,
                                    const char* title) {
            component.add("p", platform).add("uniq_id", id + "_" + name).add("name", title);
            component.add("ent_cat", "diagnostic");
        };
        {
            auto connection = all.object("connection");
            describe(connection, "binary_sensor", "connection", "Connection");
            connection.add("dev_cla", "connectivity").add("stat_t", gateway_state());
            connection.add("pl_on", online()).add("pl_off", leaving());
        }
        {
            auto boards = all.object("boards");
            describe(boards, "sensor", "boards", "Boards online");
            boards.add("stat_t", standing_topic()).add("val_tpl", "{{ value_json.boards }}");
            boards.add("avty_t", gateway_state());
        }
        if (!options_.started.empty()) {
            auto started = all.object("started");
            describe(started, "sensor", "started", "Started");
            started.add("dev_cla", "timestamp").add("stat_t", standing_topic());
            started.add("val_tpl", "{{ value_json.started }}");
        }
    }
    return text;
}

std::string HomeAssistant::standing(std::size_t boards_online) const {
    std::string text;
    {
        ObjectText standing(text);
        standing.add_number("boards", static_cast<double>(boards_online));
        if (!options_.started.empty()) standing.add("started", options_.started);
    }
    return text;
}

}  // namespace asip::gateway::exports
