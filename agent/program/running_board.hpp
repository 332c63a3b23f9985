// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/steady_timer.hpp>
#include <memory>

#include "agent/program/supervisor.hpp"

namespace asip::agent {

struct Supervisor::Board : std::enable_shared_from_this<Supervisor::Board> {
    // For a board with a process to itself, which waits for a person, or for a broker that comes up.
    static constexpr Duration kFirstPauseAlone = std::chrono::minutes(1);
    static constexpr Duration kLongestPauseAlone = std::chrono::minutes(5);
    static constexpr Duration kFirstPause = std::chrono::seconds(4);
    static constexpr Duration kLongestPause = std::chrono::minutes(1);

    Board(boost::asio::io_context& io, PlannedBoard planned, bool several)
        : plan(std::move(planned)),
          pause(several ? kFirstPause : kFirstPauseAlone, several ? kLongestPause : kLongestPauseAlone),
          start_timer(io) {}

    PlannedBoard plan;
    std::unique_ptr<BoardAgent> agent;  // none: it waits to be started
    mqtt::Backoff pause;
    boost::asio::steady_timer start_timer;
    Time started{};
    int last_status = 0;
    bool name_taken = false;  // another agent took it: to take it back would never end
    bool wanted = true;       // not: it leaves
    bool changed = false;     // it ends to be started by its new plan
    unsigned number = 0;      // of lent boards, from 0: no two that are there have the same
};

}  // namespace asip::agent
