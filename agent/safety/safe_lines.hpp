// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "asip/session/board_session.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Requests that make the board safe. They are sent ahead of every queue, and again and again until the board
/// is known to have executed or refused them, also after a time without a board. Each request stands in it
/// once. Pure.
class SafeLines {
  public:
    struct Done {
        std::string line;
        bool executed = true;
        int code = 0;      ///< the board's error where it was not executed
        std::string text;  ///< the board's words
    };

    /// Nothing happens where the same line is pending already.
    void add(const std::string& line) { pending_.try_emplace(line); }
    bool pending(std::string_view line) const { return pending_.contains(line); }
    /// Requests that the board has not confirmed.
    std::size_t size() const { return pending_.size(); }

    /// Sends what is not under way, if there is a board.
    void send(session::BoardSession& session, Time now, session::Actions& actions);
    /// True: the request was one of ours. `done` is filled in where that was the end of it.
    bool on_finished(const session::Finished& end, std::vector<Done>& done);
    /// The board restarted: nothing is on any more.
    void clear();

  private:
    struct Line {
        session::RequestId request = 0;  // 0: not under way
    };
    std::map<std::string, Line, std::less<>> pending_;
    std::unordered_map<session::RequestId, std::string> requests_;
};

}  // namespace asip::agent
