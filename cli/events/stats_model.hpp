// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asip/time.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {

/// What `asipctl top --stats` shows: what agents say that they counted. Pure.
class StatsModel {
  public:
    /// A message on a board's `$stats`. Anybody may have written it; what is no JSON object is passed over.
    void take(const std::string& board, const std::string& payload, Time now);

    bool empty() const { return boards_.empty(); }
    Table table(Time now) const;
    /// The documents as they came, by board, with `age` in seconds.
    std::vector<nlohmann::json> records(Time now) const;

  private:
    struct Board {
        nlohmann::json document;
        Time seen;
    };
    std::map<std::string, Board> boards_;
};

}  // namespace asip::cli
