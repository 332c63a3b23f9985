// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

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

}  // namespace asip::gateway::exports
