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
/// is known to have executed or refused them: one refusal may be that of a line that was damaged on its way,
/// so only kRefusals in a row count. Also after a time without a board. Each request stands in it once. Pure.
class SafeLines {
  public:
    struct Done {
        std::string line;
        bool executed = true;
        int code = 0;      ///< the board's error where it was not executed
        std::string text;  ///< the board's words
    };

    static constexpr int kRefusals = 3;

    /// Nothing happens where the same line is pending already.
    void add(const std::string& line) { pending_.try_emplace(line); }
    bool pending(std::string_view line) const { return pending_.contains(line); }
    /// Requests that the board has not confirmed.
    std::size_t size() const { return pending_.size(); }

    /// Sends what is not under way, if there is a board. `session`: a BoardSession, or what it is made of.
    template <class Session>
    void send(Session& session, Time now, session::Actions& actions);
    /// True: the request was one of ours. `done` is filled in where that was the end of it.
    bool on_finished(const session::Finished& end, std::vector<Done>& done);
    /// The board restarted: nothing is on any more.
    void clear();

  private:
    /// Of one attempt. The board answers within milliseconds; after a second something was lost.
    static constexpr Duration kAttempt = std::chrono::seconds(1);

    struct Line {
        session::RequestId request = 0;  // 0: not under way
        int refused = 0;                 // in a row
    };
    std::map<std::string, Line, std::less<>> pending_;
    std::unordered_map<session::RequestId, std::string> requests_;
};

template <class Session>
void SafeLines::send(Session& session, Time now, session::Actions& actions) {
    if (!session.accepts_requests()) return;
    for (auto& [line, state] : pending_) {
        if (state.request != 0) continue;
        const auto id = session.submit(line, {.deadline = now + kAttempt, .urgent = true}, now, actions);
        if (!id) return;
        state.request = *id;
        requests_.emplace(*id, line);
    }
}

}  // namespace asip::agent
