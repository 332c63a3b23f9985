// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/truth/dice.hpp"
#include "tests/truth/live/live_board.hpp"
#include "tests/truth/live/machine.hpp"
#include "tests/truth/live/tcp_client.hpp"

namespace truth {

constexpr std::int64_t kDeadlineMs = 5000;
// The longest pause of broker or agent, and what the programs need besides.
constexpr std::int64_t kSlackMs = 2000;
// By which the test itself may see things late.
constexpr std::int64_t kLagMs = 300;

struct Counts {
    std::uint64_t rounds = 0, commands = 0, faults = 0, incidents = 0, ok = 0, error = 0, doubt = 0,
                  timeout = 0, refused = 0, repeated = 0, nobody_there = 0, starved = 0, invisible = 0,
                  failures = 0, not_begun = 0, own_reconnects = 0, redelivered = 0;
};

/// One command: a PWM duty that this pin has never had before.
struct Sent {
    LiveBoard* board;
    int pin = 0;
    int duty = 0;  ///< 0: a request that the board or the agent must not execute
    bool tcp = false;
    std::string request{};
    std::int64_t at = 0;
    std::int64_t answered = 0;
    int copies = 1;  ///< how often the same message was sent
    int answers = 0;
    std::string status{};
    std::string answer{};
};

/// A board's agent, or the broker, is not there: what is under way then is not answered.
struct Downtime {
    const LiveBoard* board;
    std::int64_t from;
    std::size_t announced;  ///< how often the agent had been announced when it began
    std::int64_t until = std::numeric_limits<std::int64_t>::max();
    bool over() const { return until != std::numeric_limits<std::int64_t>::max(); }
};

class Round {
  public:
    /// The board with our firmware is an Uno, or a Pico that the script `pico` runs.
    Round(std::uint64_t seed, Counts& counts, const std::string& pico);
    void run(std::int64_t active_ms);

  private:
    void connect();
    void set_up();
    bool online(const LiveBoard& board) const;
    void pump();
    void command_over_bus();
    void command_over_tcp();
    void take_replies();
    void answered(Sent& sent, std::string status, std::string answer);
    void incident();
    void note(std::string what) { story_.emplace_back(now_ms(), std::move(what)); }
    void tell() const;
    void drain();
    void check();
    void check(const Sent& sent);
    bool nobody_there(const Sent& sent) const;
    /// In time of the machine: see Machine.
    std::int64_t passed_ms(std::int64_t from, std::int64_t until = now_ms()) const;
    bool executed(const Sent& sent) const;
    void fail(const Sent& sent, const std::string& what);
    std::size_t announced(const LiveBoard& board) const;
    void begin_outage(const LiveBoard& board) { outages_.push_back({&board, now_ms(), announced(board)}); }
    void end_outages();
    void watch_own_connection();

    std::uint64_t seed_;
    Counts& counts_;
    Dice dice_;
    asip::test::MosquittoBroker broker_;
    std::vector<std::unique_ptr<LiveBoard>> boards_;
    std::vector<std::unique_ptr<TcpClient>> clients_;  // two of each board
    std::unique_ptr<asip::test::BusProbe> probe_;
    std::size_t replies_seen_ = 0;
    int reconnects_seen_ = 0;
    std::int64_t connected_ = 0;  // when the probe was last seen connected
    bool broker_restarted_ = false;
    std::int64_t broker_died_ = std::numeric_limits<std::int64_t>::min() / 2;
    std::deque<Sent> sent_;
    std::array<std::array<int, 16>, 2> duties_{};
    std::vector<Downtime> outages_;
    Machine machine_;
    std::vector<std::pair<std::int64_t, std::string>> story_;  // the incidents, and wrong answers
    std::vector<std::pair<std::int64_t, std::function<void()>>> later_;
};

}  // namespace truth
