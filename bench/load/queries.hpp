// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench/load/calling.hpp"
#include "bench/load/fleet.hpp"
#include "bench/load/pace.hpp"
#include "bench/load/pending.hpp"
#include "bench/load/questions.hpp"

namespace asip::load {

/// Asks registries at a steady rate, over a few connections of its own in turn, as asipctl and the gateway
/// do: whichever registry answers first, and for the next page the one that gave the page before. Judges each
/// answer about one board: an answer is wrong where it misses a board that each registry must know by then.
class Queries {
  public:
    /// Enough that the connections themselves are not what is measured.
    static constexpr std::size_t kConnections = 4;

    /// `fleet` and `io` must outlive it; of `kind` only the names of services are taken. `per_second`:
    /// questions, above 0.
    Queries(boost::asio::io_context& io, const mqtt::Options& options, const std::string& topic_root,
            const BoardKind& kind, const Fleet& fleet, double per_second);

    /// Connects, and begins to ask.
    void start();
    /// Asks no more; answers that are under way are still counted.
    void stop() { timer_.cancel(), stopped_ = true; }
    /// No answer is awaited any more. For a caller that waits for that after stop().
    bool idle(Time now);
    QueryTally tally() const;

  private:
    /// What is known of a question when it is asked.
    struct Asked {
        Question question;
        Time sent;
        std::optional<Time> there_since;  // a board that each registry must know
        std::string id{};
    };

    void schedule();
    void ask_due();
    void ask(Calling& connection);
    void answered(const Asked& asked, const std::string& payload);
    std::optional<Time> there_since(const Question& question, Time now) const;
    void forget_overdue(Time now);

    const Fleet& fleet_;
    bus::Topics topics_;
    Questions questions_;
    std::vector<std::unique_ptr<Calling>> connections_;
    boost::asio::steady_timer timer_;
    Pace pace_;
    Pending pending_;
    std::size_t next_ = 0;
    Time swept_{};
    QueryTally tally_;
    bool stopped_ = false;
};

}  // namespace asip::load
