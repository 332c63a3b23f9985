// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/model_set.hpp"
#include "asip/session/interview.hpp"

namespace asip::session {

/// The services of a board with their models and their names on the bus: the model's name; the letter for a
/// service without model, or not the first of its kind. Agents and direct clients take names from here alone.
class ServiceTable {
  public:
    struct Entry {
        char letter = 0;
        std::string name;       ///< unique on the board
        std::string title;      ///< the friendly name that the board gives; may be empty
        model::ModelPtr model;  ///< null: there is no model for it
    };

    ServiceTable() = default;
    /// In the order of `board`. `models` need not outlive the table.
    ServiceTable(const Identity& board, const model::ModelSet& models);

    // Each returns null where there is none; valid as long as the table.
    const Entry* find(char letter) const;
    /// By the name on the bus.
    const Entry* find(std::string_view name) const;
    const std::vector<Entry>& entries() const { return entries_; }

  private:
    std::vector<Entry> entries_;
};

}  // namespace asip::session
