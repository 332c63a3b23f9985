// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "asip/session/board_session.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Requests that make the board safe. They go ahead of every queue, again and again, across absences of the
/// board, until it has executed or refused them. A refusal may mean a damaged line, so kRefusals in a row
/// count. Pure.
class SafeLines {
  public:
    struct Done {
        std::string line;
        std::string sent;  ///< the same as the board got it
        bool executed = true;
        int code = 0;      ///< the board's error where it was not executed
        std::string text;  ///< the board's words
    };

    static constexpr int kRefusals = 3;

    /// Adding a pending line changes nothing.
    void add(const std::string& line) { pending_.try_emplace(line); }
    bool pending(std::string_view line) const { return pending_.contains(line); }
    std::size_t size() const { return pending_.size(); }

    /// Sends what is not under way, if there is a board. `session`: a BoardSession, or what it is made of.
    /// `wire`: a line as the board gets it.
    template <class Session, class Wire = std::identity>
    void send(Session& session, Time now, session::Actions& actions, Wire wire = {});
    /// True: the request was one of ours. `done`: filled in where that settled it.
    bool on_finished(const session::Finished& end, std::vector<Done>& done);
    void clear();

  private:
    /// For one attempt: boards answer within milliseconds, so after a second something was lost.
    static constexpr Duration kAttempt = std::chrono::seconds(1);

    struct Line {
        session::RequestId request = 0;  // 0: not under way
        std::string sent{};
        int refused = 0;  // in a row
    };
    std::map<std::string, Line, std::less<>> pending_;
    std::unordered_map<session::RequestId, std::string> requests_;
};

template <class Session, class Wire>
void SafeLines::send(Session& session, Time now, session::Actions& actions, Wire wire) {
    if (!session.accepts_requests()) return;
    for (auto& [line, state] : pending_) {
        if (state.request != 0) continue;
        auto sent = wire(line);
        const auto id = session.submit(sent, {.deadline = now + kAttempt, .urgent = true}, now, actions);
        if (!id) return;
        state.request = *id;
        state.sent = std::move(sent);
        requests_.emplace(*id, line);
    }
}

}  // namespace asip::agent
