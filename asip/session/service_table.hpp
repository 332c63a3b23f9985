// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/model_set.hpp"
#include "asip/session/interview.hpp"

namespace asip::session {

/// The services of one board with their models and with the names by which commands and events reach them:
/// the model's name, and the letter for a service that has no model or is not the first of its kind. The one
/// place where these names are given, for agents and for clients that talk to a board directly.
class ServiceTable {
  public:
    struct Entry {
        char letter = 0;
        std::string name;       ///< unique on the board
        std::string title;      ///< the friendly name that the board gives; may be empty
        model::ModelPtr model;  ///< null: there is no model for it
    };

    ServiceTable() = default;
    /// The services of `board` in its order. Models are shared with `models`, which need not outlive the
    /// table.
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
