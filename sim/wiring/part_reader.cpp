// SPDX-License-Identifier: Apache-2.0
#include "sim/wiring/part_reader.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace asip::sim {

int PartReader::parse(const std::string& key, const nlohmann::json& value) {
    const auto pin = board_.parse_pin(value.is_string() ? value.get<std::string>() : value.dump());
    if (!pin) settings_.fault(key, pin.error());
    return pin.value_or(0);
}

int PartReader::pin(const std::string& key) {
    const auto* value = settings_.required(key);
    return value == nullptr ? 0 : parse(key, *value);
}

std::vector<int> PartReader::pins(const std::string& key, std::vector<int> otherwise) {
    const auto* list = settings_.find(key);
    if (list == nullptr) return otherwise;
    if (!list->is_array() || list->size() != otherwise.size()) {
        settings_.fault(key, fmt::format("is a list of {} pins", otherwise.size()));
        return otherwise;
    }
    for (std::size_t i = 0; i < otherwise.size(); ++i)
        otherwise[i] = parse(key, (*list)[i]);
    return otherwise;
}

std::string PartReader::text(const std::string& key) {
    if (settings_.required(key) == nullptr) return {};
    auto text = settings_.text(key);
    if (text.empty()) settings_.fault(key, "is empty");
    return text;
}

void PartReader::each(const std::string& key, const std::function<void(PartReader&)>& read) {
    constexpr std::size_t kMostItems = 64;
    for (auto& item : settings_.list(key, kMostItems)) {
        PartReader reader(item, board_, has_world_);
        read(reader);
        item.refuse_others();
    }
}

void PartReader::need_world() {
    if (!has_world_) settings_.fault("", "needs a world: \"world\" of the board names its file");
}

}  // namespace asip::sim
