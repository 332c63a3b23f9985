// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <string>
#include <unordered_map>

#include "bench/load/calling.hpp"
#include "bench/load/fleet.hpp"
#include "bench/load/pace.hpp"
#include "bench/load/pending.hpp"

namespace asip::load {

/// What became of the commands, counted from the start.
struct CommandTally {
    /// `unanswered`: no answer came within Pending::kPatience, or none has come yet.
    std::uint64_t sent = 0, ok = 0, refused = 0, unanswered = 0;
    std::uint64_t left_out = 0;  ///< too many waited for their answers
    Times answered;              ///< from a command to its answer
};

/// Commands boards at a steady rate, one after the other, each service in turn, over a connection of its own.
/// Boards that are not announced are passed over. A rate that the bus cannot keep up with is not made up for
/// later: commands beyond Pending::kMax are left out and counted.
class Commander {
  public:
    /// `kind`, `fleet` and `io` must outlive it. `options`: of its connection. `per_second`: commands, above
    /// 0.
    Commander(boost::asio::io_context& io, mqtt::Options options, const std::string& topic_root,
              const BoardKind& kind, const Fleet& fleet, double per_second);

    /// Connects; the first command leaves as soon as a board is announced.
    void start();
    /// Sends no more; answers that are under way are still counted.
    void stop() { timer_.cancel(), stopped_ = true; }
    /// No answer is awaited any more. For a caller that waits for that after stop().
    bool idle(Time now);
    CommandTally tally() const;

  private:
    void schedule();
    void send_due();
    void send(std::size_t board, const BoardKind::Service& service);

    const BoardKind& kind_;
    const Fleet& fleet_;
    Calling bus_;
    boost::asio::steady_timer timer_;
    Pace pace_;
    std::unordered_map<std::size_t, caller::Caller::Call> waiting_;  // by number
    std::size_t next_ = 0;
    CommandTally tally_;
    bool stopped_ = false;
};

}  // namespace asip::load
