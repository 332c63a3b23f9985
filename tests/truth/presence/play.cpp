// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/play.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace truth::presence {
namespace {

using namespace std::chrono_literals;
using asip::model::to_text;

// A claim takes 1.3 s, a challenge as long, an answer to a probe 0.9 s.
constexpr Duration kQuiet = 5s;
constexpr Duration kStep = 500ms;

Setting draw_setting(Dice& dice, bool changes_hands) {
    Setting setting;
    setting.in_order = !dice.chance(changes_hands ? 0.5 : 0.3);
    setting.says_state = !setting.in_order || dice.chance(0.75);
    setting.lease = static_cast<int>(dice.chance(0.8) ? dice.between(3, 10) : dice.between(11, 40));
    dice.chance(0.2);  // stays, so that the seeds of earlier failures play the same histories
    return setting;
}

}  // namespace

Play::Play(std::uint64_t seed, bool with_trace, const std::string& watched,
           std::vector<std::string>* recorded)
    : dice_(seed),
      clock_of_second_(clock_of_second(seed)),
      setting_(draw_setting(dice_, clock_of_second_.has_value())),
      with_trace_(with_trace),
      recorded_(recorded),
      broker_(dice_, setting_.in_order) {
    note(fmt::format("seed {}: {}, {}, lease {} s", seed, setting_.in_order ? "in order" : "bridged brokers",
                     setting_.says_state ? "agents that say states" : "older agents", setting_.lease));
    if (!watched.empty())
        broker_.watch = [this, watched](SimBroker::Client to, const Message& message, Time at) {
            for (const auto& view : views_)
                if (view->client() == to && view->name() == watched)
                    end_.trace.push_back(fmt::format(
                        "{:8.3f}   {}{}{} {}", seconds(at), message.topic, message.retain ? ", stored" : "",
                        message.expiry_seconds ? fmt::format(", {} s left", *message.expiry_seconds) : "",
                        message.payload.substr(0, 300)));
        };
    for (std::size_t i = 0; i < 2; ++i) {
        auto name = fmt::format("b{}", i);
        agents_.push_back(std::make_unique<SimAgent>(broker_, dice_, name, truths_[i], setting_.lease,
                                                     setting_.says_state));
        agents_.push_back(std::make_unique<SimAgent>(broker_, dice_, name, truths_[i], setting_.lease,
                                                     setting_.says_state));
    }
    views_.push_back(make_registry(broker_, dice_, "r1", now_));
    views_.push_back(make_gateway(broker_, dice_));
    views_.push_back(bus_view());
    for (auto& view : views_)
        view->start(now_);
}

std::unique_ptr<View> Play::bus_view() {
    return recorded_ != nullptr ? make_recorded_view(broker_, *recorded_) : make_bus_view(broker_);
}

void Play::note(std::string what) {
    if (with_trace_) end_.trace.push_back(fmt::format("{:8.3f} {}", seconds(now_), what));
}

Duration Play::some_time() {
    return std::chrono::milliseconds(dice_.chance(0.5) ? dice_.between(1, 3000)
                                                       : dice_.between(1, setting_.lease * 1500));
}

SimAgent& Play::some_agent() {
    return *agents_[dice_.below(agents_.size())];
}

void Play::start(SimAgent& agent) {
    // Clocks jump: that of a machine without one goes back at each start.
    const std::int64_t skew = dice_.chance(0.3) ? dice_.between(-2000, 2000) : 0;
    start(agent, skew, dice_.chance(0.3));
}

void Play::start(SimAgent& agent, std::int64_t skew, bool takeover) {
    note(fmt::format("agent of {} starts, its clock off by {} s{}", agent.board(), skew,
                     takeover ? ", and takes over" : ""));
    const auto& truth = truths_[agent.board().back() - '0'];
    const auto before = truth.before(agent, now_);
    agent.start(skew, takeover, now_);
    const Clock clock = truth.session.empty()             ? Clock::kFirst
                        : agent.session() < truth.session ? Clock::kBehind
                                                          : Clock::kLater;
    end_.counts.starts.add({clock, before, !setting_.in_order, takeover});
}

void Play::become(SimAgent& agent, BoardState state, StateReason reason) {
    note(fmt::format("{} becomes {} {}", agent.board(), to_text(state), to_text(reason)));
    promptly(agent, [&] { agent.becomes(state, reason, now_); });
}

void Play::promptly(SimAgent& agent, const std::function<void()>& happens) {
    const std::size_t number = agent.board().back() - '0';
    const auto& agents = truths_[number].agents;
    const bool alone =
        std::count_if(agents.begin(), agents.end(), [](const SimAgent* one) { return one->claims(); }) == 1;
    const bool certain = setting_.in_order && setting_.says_state && alone && agent.is_heard() &&
                         truths_[number].said.announced;
    // Else it asks for 1.3 s whether the later session lives.
    const bool is_later = certain && truths_[number].session == agent.session();
    happens();
    if (!certain || dice_.chance(0.5) || !is_later) return;
    pass(kPromised + 1ms);
    compare_now(number);
}

void Play::join() {
    const auto kind = dice_.below(4);
    note(fmt::format("a late joiner: {}", kind));
    const auto at = std::min<std::size_t>(kind + 3, views_.size());
    auto view = kind == 0   ? make_gateway(broker_, dice_)
                : kind == 1 ? bus_view()
                            : make_registry(broker_, dice_, fmt::format("r{}", ++registries_), now_);
    if (at == views_.size())
        views_.push_back(std::move(view));
    else
        views_[at] = std::move(view);
    views_[at]->start(now_);
}

void Play::pass(Duration time) {
    const Time until = now_ + time;
    while (now_ < until) {
        Time next = std::min(until, now_ + kStep);
        for (const auto& agent : agents_)
            if (const auto due = agent->next(); due && *due < next) next = *due;
        if (const auto due = broker_.next(); due && *due < next) next = *due;
        now_ = std::max(next, now_ + 1us);
        broker_.deliver_until(now_);
        for (const auto& agent : agents_)
            agent->tick(now_);
        if (now_ < next_tick_) continue;
        next_tick_ = now_ + kStep;
        for (const auto& view : views_)
            view->tick(now_);
    }
}

void Play::compare() {
    pass(kQuiet + judge_.settling() - kPromised);
    for (std::size_t i = 0; i < 2; ++i)
        compare_now(i);
}

void Play::compare_now(std::size_t number) {
    const auto name = fmt::format("b{}", number);
    for (const auto& view : views_) {
        if (!end_.failure.empty()) return;
        const auto& truth = truths_[number];
        std::string wrong;
        if (view->is_connected()) wrong = judge_.says(*view, name, truth, now_, end_.counts.comparisons);
        if (wrong.empty()) wrong = judge_.told(*view, name, truth);
        if (!wrong.empty()) fail(*view, name, wrong, truth.really(now_));
    }
}

void Play::fail(const View& view, const std::string& board, const std::string& what, const Really& really) {
    end_.failure = fmt::format("{:.3f} s: {} (since {:.3f} s) {} {}; really: {} {} since {:.3f} s",
                               seconds(now_), view.name(), seconds(view.started_at()), what, board,
                               really.announced ? to_text(really.state) : "unknown", to_text(really.reason),
                               seconds(really.since));
    note(end_.failure);
    if (!with_trace_) return;
    for (const auto& change : view.changes_of(board))
        note("told: " + change);
    for (const auto& word : truths_[board.back() - '0'].words)
        note("said: " + word.text + (word.unless_heard ? " (by an earlier session)" : ""));
}

}  // namespace truth::presence
