#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/model/model_set.hpp"
#include "asip/session/identity.hpp"

namespace asip::agent {

/// The services of one board with their names on the bus and their models.
class ServiceTable {
  public:
    struct Entry {
        char letter = 0;
        std::string name;       ///< the model's, else the letter
        std::string title;      ///< as the board says it
        model::ModelPtr model;  ///< null: nobody described it
    };

    ServiceTable() = default;
    ServiceTable(const session::Identity& board, const model::ModelSet& models);

    const Entry* find(char letter) const;
    const Entry* find(std::string_view name) const;
    const std::vector<Entry>& entries() const { return entries_; }

  private:
    std::vector<Entry> entries_;
};

}  // namespace asip::agent
