// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exported_board.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {
namespace {

std::string label_of(const model::Description& description, const char* key) {
    const auto found = description.labels.labels.find(key);
    return found == description.labels.labels.end() ? std::string() : found->second;
}

}  // namespace

std::optional<ExportedBoard> exported_board(const bus::BoardItem& item, const std::vector<Property>* list,
                                            const property::FindModel& find_model) {
    if (item.description.empty()) return std::nullopt;
    const auto description = model::parse_description(item.description);
    if (!description) return std::nullopt;
    ExportedBoard board;
    board.board = item.board;
    board.name = label_of(*description, "name");
    board.room = label_of(*description, "room");
    board.chip = description->firmware.chip;
    board.sketch = description->firmware.sketch;
    board.properties = list != nullptr ? *list : property::properties_of(*description, find_model);
    return board;
}

std::vector<Shown> reported_values(const ExportedBoard& board, const std::vector<std::size_t>& properties,
                                   std::string_view text, std::uint64_t& refused) {
    std::vector<Shown> result;
    const auto published = model::parse_json(text);
    if (!published) return result;
    for (const auto index : properties) {
        const auto& property = board.properties[index];
        if (!is_reported(property)) continue;
        const auto* raw = property::raw_in(*property.read, *published);
        if (raw == nullptr) continue;
        if (auto value = property::value_of(property, *raw))
            result.push_back({index, std::move(*value)});
        else
            ++refused;
    }
    return result;
}

}  // namespace asip::gateway::exports
