// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/truth/presence/history.hpp"
#include "tests/truth/presence/judge.hpp"
#include "tests/truth/presence/sim_agent.hpp"
#include "tests/truth/presence/views.hpp"

namespace truth::presence {

/// The agents of two boards, a broker, programs that look at them, and time; what happens is up to a History.
class Play {
  public:
    /// As run_history().
    Play(std::uint64_t seed, bool with_trace, const std::string& watched, std::vector<std::string>* recorded);

  protected:
    std::unique_ptr<View> bus_view();
    void note(std::string what);
    Duration some_time();
    SimAgent& some_agent();

    void start(SimAgent& agent);
    void start(SimAgent& agent, std::int64_t skew, bool takeover);
    void become(SimAgent& agent, BoardState state, StateReason reason);
    /// What happens to a board that is announced is in every view in time.
    void promptly(SimAgent& agent, const std::function<void()>& happens);
    /// A program starts, or starts again.
    void join();

    void pass(Duration time);
    /// All that is under way has arrived.
    void compare();
    void compare_now(std::size_t number);
    void fail(const View& view, const std::string& board, const std::string& what, const Really& really);

    Dice dice_;
    std::optional<Clock> clock_of_second_;
    Setting setting_;
    bool with_trace_;
    std::vector<std::string>* recorded_;
    End end_;
    Time now_ = kBegin;
    Time next_tick_ = kBegin;
    int registries_ = 1;
    SimBroker broker_;
    Judge judge_{setting_, broker_};
    BoardTruth truths_[2];
    std::vector<std::unique_ptr<SimAgent>> agents_;
    std::vector<std::unique_ptr<View>> views_;
};

}  // namespace truth::presence
