// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exported_board.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/registry/board_match.hpp"
#include "asip/model/json.hpp"
#include "gateway/export/entities.hpp"

namespace asip::gateway::exports {
namespace {

std::string label_of(const model::Description& description, const char* key) {
    const auto found = description.labels.labels.find(key);
    return found == description.labels.labels.end() ? std::string() : found->second;
}

}  // namespace

std::optional<ExportedBoard> exported_board(const bus::BoardItem& item, const model::ModelSet& models) {
    if (item.description.empty()) return std::nullopt;
    const auto description = model::parse_description(item.description);
    if (!description) return std::nullopt;
    ExportedBoard board;
    board.board = item.board;
    board.name = label_of(*description, "name");
    board.room = label_of(*description, "room");
    board.chip = description->firmware.chip;
    board.sketch = description->firmware.sketch;
    board.entities = entities_of(
        *description, [&](const model::ServiceInfo& service) { return bus::model_of(service, models); });
    return board;
}

std::vector<std::pair<std::size_t, std::optional<nlohmann::json>>> shown_values(
    const ExportedBoard& board, const std::vector<std::size_t>& entities, std::string_view text, bool set) {
    std::vector<std::pair<std::size_t, std::optional<nlohmann::json>>> result;
    nlohmann::json published;
    if (!text.empty()) {
        auto parsed = model::parse_json(text);
        if (!parsed) return result;
        published = std::move(*parsed);
    }
    for (const auto index : entities) {
        const auto& entity = board.entities[index];
        if (entity.read.has_value() == set) continue;
        auto value = set ? value_set(entity, published) : value_in(entity, published);
        if (value || set) result.emplace_back(index, std::move(value));
    }
    return result;
}

bool is_there(std::string_view state) {
    return state == "online" || state == "sleeping";
}

}  // namespace asip::gateway::exports
