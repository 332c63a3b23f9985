#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/model_set.hpp"
#include "asip/session/identity.hpp"

namespace asip::session {

/// The services of one board with their models and with the names by which commands and events reach them:
/// the model's name, and the letter of a service that has no model or is not the first of its kind.
class ServiceTable {
  public:
    struct Entry {
        char letter = 0;
        std::string name;       ///< unique on the board
        std::string title;      ///< as the board says it
        model::ModelPtr model;  ///< null: there is no model for it
    };

    ServiceTable() = default;
    ServiceTable(const Identity& board, const model::ModelSet& models);

    const Entry* find(char letter) const;
    const Entry* find(std::string_view name) const;
    const std::vector<Entry>& entries() const { return entries_; }

  private:
    std::vector<Entry> entries_;
};

}  // namespace asip::session
