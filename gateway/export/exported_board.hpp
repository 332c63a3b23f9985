// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/model/model_set.hpp"
#include "gateway/export/entity.hpp"

namespace asip::gateway::exports {

/// A board as dialects see it.
struct ExportedBoard {
    std::string board;  ///< its name on the bus
    std::string name;   ///< for people
    std::string chip;   ///< may be empty, as all below
    std::string sketch;
    std::string room;
    std::vector<Entity> entities;
    friend bool operator==(const ExportedBoard&, const ExportedBoard&) = default;

    /// Null: it has none of this id.
    const Entity* entity(std::string_view id) const {
        for (const auto& each : entities)
            if (each.id == id) return &each;
        return nullptr;
    }
};

/// Of a board as the catalogue has it, with its whole description. Nothing: it has none.
std::optional<ExportedBoard> exported_board(const bus::BoardItem& item, const model::ModelSet& models);
/// What the message `text` of a service says of those of the board's entities (their numbers) that belong to
/// the service: reports, or with `set` what was set. Without a value: what was set is not known any more.
std::vector<std::pair<std::size_t, std::optional<nlohmann::json>>> shown_values(
    const ExportedBoard& board, const std::vector<std::size_t>& entities, std::string_view text, bool set);
/// Whether a board in this state of the catalogue takes commands.
bool is_there(std::string_view state);

}  // namespace asip::gateway::exports
