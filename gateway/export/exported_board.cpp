// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exported_board.hpp"

#include "asip/bus/registry/board_match.hpp"
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

bool is_there(std::string_view state) {
    return state == "online" || state == "sleeping";
}

}  // namespace asip::gateway::exports
