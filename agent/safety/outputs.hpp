// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "asip/session/board_session.hpp"

namespace asip::agent {

/// What clients switched on since the board restarted, as the requests that undo it: `I,d,13,0` for pin 13.
/// Services that their model can stop as a whole are not in here. Beyond kMax nothing is remembered, and a
/// stop does not undo it. Pure.
class Outputs {
  public:
    static constexpr std::size_t kMax = 512;

    /// A request was queued that `safe` undoes.
    void queued(const std::string& safe) {
        if (lines_.size() < kMax) lines_.try_emplace(safe, false);
    }
    /// Such a request ended. What the board did not execute needs no undoing.
    void on_finished(const session::Finished& end, std::string_view safe) {
        const auto line = lines_.find(safe);
        if (line == lines_.end()) return;
        const bool not_executed =
            end.ending == session::Ending::kNotSent || end.ending == session::Ending::kBoardError;
        if (!not_executed) line->second = true;
        if (not_executed && !line->second) lines_.erase(line);
    }
    void board_restarted() { lines_.clear(); }

    std::vector<std::string> lines() const {
        std::vector<std::string> lines;
        for (const auto& [line, executed] : lines_)
            lines.push_back(line);
        return lines;
    }

  private:
    std::map<std::string, bool, std::less<>> lines_;  // -> the board may have executed such a request
};

}  // namespace asip::agent
