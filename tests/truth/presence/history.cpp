// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "tests/truth/presence/judge.hpp"
#include "tests/truth/presence/sim_agent.hpp"
#include "tests/truth/presence/views.hpp"

namespace truth::presence {
namespace {

using namespace std::chrono_literals;
using asip::model::to_text;

// A claim takes 1.3 s, a challenge as long, an answer to a probe 0.9 s.
constexpr Duration kQuiet = 5s;
constexpr Duration kPromisedOfBroker = 3s;  // all is right again, after the broker was away
constexpr Duration kStep = 500ms;

Setting draw_setting(Dice& dice, bool changes_hands) {
    Setting setting;
    setting.in_order = !dice.chance(changes_hands ? 0.5 : 0.3);
    setting.says_state = !setting.in_order || dice.chance(0.75);
    setting.lease = static_cast<int>(dice.chance(0.8) ? dice.between(3, 10) : dice.between(11, 40));
    dice.chance(0.2);  // stays, so that the seeds of earlier failures play the same histories
    return setting;
}

class History {
  public:
    History(std::uint64_t seed, bool with_trace, const std::string& watched,
            std::vector<std::string>* recorded)
        : dice_(seed),
          clock_of_second_(clock_of_second(seed)),
          setting_(draw_setting(dice_, clock_of_second_.has_value())),
          with_trace_(with_trace),
          recorded_(recorded),
          broker_(dice_, setting_.in_order) {
        note(fmt::format("seed {}: {}, {}, lease {} s", seed,
                         setting_.in_order ? "in order" : "bridged brokers",
                         setting_.says_state ? "agents that say states" : "older agents", setting_.lease));
        if (!watched.empty())
            broker_.watch = [this, watched](SimBroker::Client to, const Message& message, Time at) {
                for (const auto& view : views_)
                    if (view->client() == to && view->name() == watched)
                        end_.trace.push_back(fmt::format(
                            "{:8.3f}   {}{}{} {}", seconds(at), message.topic,
                            message.retain ? ", stored" : "",
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

    End run() {
        // Many short ones find more than few long ones; what needs many actions is rare.
        if (clock_of_second_) change_hands(*clock_of_second_);
        const auto actions = dice_.chance(0.05) ? dice_.between(5, 12) : dice_.between(1, 4);
        for (std::int64_t i = 0; i < actions && end_.failure.empty(); ++i) {
            act();
            ++end_.counts.actions;
            pass(some_time());
            if (dice_.chance(0.2)) compare();
        }
        compare();
        ++end_.counts.histories;
        return std::move(end_);
    }

  private:
    std::unique_ptr<View> bus_view() {
        return recorded_ != nullptr ? make_recorded_view(broker_, *recorded_) : make_bus_view(broker_);
    }
    void note(std::string what) {
        if (with_trace_) end_.trace.push_back(fmt::format("{:8.3f} {}", seconds(now_), what));
    }

    Duration some_time() {
        return std::chrono::milliseconds(dice_.chance(0.5) ? dice_.between(1, 3000)
                                                           : dice_.between(1, setting_.lease * 1500));
    }
    SimAgent& some_agent() { return *agents_[dice_.below(agents_.size())]; }

    void act() {
        auto& agent = some_agent();
        const auto& board = agent.board();
        switch (dice_.below(15)) {
            case 0:
            case 1:
            case 2:
                if (agent.runs()) return become(agent, BoardState::kLost, StateReason::kUnplugged);
                return start(agent);
            case 3:
                return become(agent, BoardState::kLost, StateReason::kSilent);
            case 4:
            case 5:
                return become(agent, BoardState::kOnline, StateReason::kNone);
            case 6:
                return become(agent, BoardState::kUpdating, StateReason::kReleased);
            case 7:
                note("agent of " + board + " is stopped");
                return promptly(agent, [&] { agent.stop(now_); });
            case 8:
                note("agent of " + board + " is killed");
                return promptly(agent, [&] { agent.kill(now_); });
            case 9:
                note("agent of " + board + " is cut off, or its network back");
                return agent.is_cut_off() ? agent.heal(now_) : agent.cut_off(now_);
            case 10:
                return probe();
            case 11:
                return join();
            case 12:
                return lose_connection();
            case 13:
                return restart_broker();
            default:
                return replay();
        }
    }

    void start(SimAgent& agent) {
        // Clocks jump: that of a machine without one goes back at each start.
        const std::int64_t skew = dice_.chance(0.3) ? dice_.between(-2000, 2000) : 0;
        start(agent, skew, dice_.chance(0.3));
    }
    void start(SimAgent& agent, std::int64_t skew, bool takeover) {
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
    /// A board gets another agent, whose clock is ahead of that of the one before it, or behind it: a machine
    /// without a clock, or with an empty battery. `kFirst`: before the first one has described itself. What
    /// became of the one before is different each time; it may come back.
    void change_hands(Clock clock) {
        const bool described = clock != Clock::kFirst;
        const auto number = dice_.below(agents_.size());
        auto& first = *agents_[number];
        auto& second = *agents_[number ^ 1];
        const auto skew = dice_.between(0, 2000);
        start(first, skew, described && dice_.chance(0.3));
        const Time began = now_;
        pass(std::chrono::milliseconds(described ? dice_.between(1400, 5000) : dice_.between(1, 1200)));
        const auto fate = described ? dice_.below(clock == Clock::kBehind ? 6 : 10) : 1 + dice_.below(3);
        if (fate % 8 == 0) {
            note("its agent ends");
            dice_.chance(0.5) ? first.stop(now_) : first.kill(now_);
        } else if (fate > 1) {
            note("its agent is cut off");
            first.cut_off(now_);
        }
        const bool waits = fate > 2 && fate != 6;  // else its lease runs
        if (waits && described) pass(std::chrono::seconds(setting_.lease));
        pass(std::chrono::milliseconds(dice_.between(1, described ? 2500 : 90)));
        if (waits && fate < 6 && (!described || dice_.chance(0.6)))
            while (first.waits_for_will())
                pass(1s);
        const auto passed = std::chrono::duration_cast<std::chrono::seconds>(now_ - began).count();
        const bool behind = clock == Clock::kBehind;
        start(second, skew + (behind ? -passed - dice_.between(1, 3000) : dice_.between(1, 3000)),
              dice_.chance(0.5));
        if (!first.is_cut_off() || dice_.chance(0.4)) return;
        pass(some_time());
        note("the agent before it is back");
        first.heal(now_);
        pass(some_time());
    }
    void become(SimAgent& agent, BoardState state, StateReason reason) {
        note(fmt::format("{} becomes {} {}", agent.board(), to_text(state), to_text(reason)));
        promptly(agent, [&] { agent.becomes(state, reason, now_); });
    }
    /// What happens to a board that is announced is in every view in time.
    void promptly(SimAgent& agent, const std::function<void()>& happens) {
        const std::size_t number = agent.board().back() - '0';
        const auto& agents = truths_[number].agents;
        const bool alone = std::count_if(agents.begin(), agents.end(),
                                         [](const SimAgent* one) { return one->claims(); }) == 1;
        const bool certain = setting_.in_order && setting_.says_state && alone && agent.is_heard() &&
                             truths_[number].said.announced;
        happens();
        if (!certain || dice_.chance(0.5)) return;
        pass(kPromised + 1ms);
        compare_now(number);
    }
    /// Everybody is back at once, within a second, and the broker has what it stored.
    void restart_broker() {
        note("the broker is gone");
        std::vector<View*> views;
        std::vector<SimAgent*> agents;
        for (const auto& view : views_)
            if (view->is_connected()) views.push_back(view.get()), view->disconnect(now_);
        for (const auto& agent : agents_)
            if (agent->runs() && !agent->is_cut_off())
                agents.push_back(agent.get()), agent->lose_broker(now_);
        pass(std::chrono::milliseconds(dice_.between(1, 8000)));
        note("the broker is back");
        for (auto* view : views)
            pass(std::chrono::milliseconds(dice_.between(0, 100))), view->connect(now_);
        for (auto* agent : agents)
            pass(std::chrono::milliseconds(dice_.between(0, 100))), agent->heal(now_);
        if (!setting_.in_order || !setting_.says_state) return;
        pass(kPromisedOfBroker);
        for (std::size_t i = 0; i < 2; ++i)
            if (truths_[i].is_heard() && !truths_[i].is_disputed()) compare_now(i);
    }
    void probe() {
        note("probe");
        Message probe;
        probe.topic = "asip/servicebus/$probe";
        broker_.publish(views_.front()->client(), std::move(probe), now_);
    }
    /// A program starts, or starts again.
    void join() {
        const auto kind = dice_.below(4);
        note(fmt::format("a late joiner: {}", kind));
        const auto at = std::min<std::size_t>(kind + 3, views_.size());
        auto view = kind == 0   ? make_gateway(broker_, dice_)
                    : kind == 1 ? bus_view()
                                : make_registry(broker_, dice_, fmt::format("r{}", ++registries_), now_);
        if (at == views_.size()) {
            views_.push_back(std::move(view));
        } else {
            views_[at] = std::move(view);
        }
        views_[at]->start(now_);
    }
    void lose_connection() {
        auto& view = *views_[dice_.below(views_.size())];
        note(view.name() + (view.is_connected() ? " loses the broker" : " has it again"));
        view.is_connected() ? view.disconnect(now_) : view.connect(now_);
    }
    /// A bridge delivers again what a program heard before, in whatever order; not the newest description,
    /// which may renew a lease.
    void replay() {
        auto& view = *views_[dice_.below(views_.size())];
        const auto& all = broker_.published();
        if (!view.is_connected() || all.empty() || !setting_.says_state) return;
        const auto& [at, message] = all[dice_.below(all.size())];
        const bool newest = message.topic.ends_with("/$description") &&
                            std::none_of(all.begin(), all.end(), [&](const auto& other) {
                                return other.second.topic == message.topic && other.first > at;
                            });
        const bool state = message.topic.ends_with("/$state");
        const auto described = judge_.last_description(message.topic.substr(16, 2));
        if (at < view.connected_at() || newest || (state && at + 4s > described)) return;
        note("replayed to " + view.name() + ": " + message.topic + " of " +
             fmt::format("{:.3f}", seconds(at)) + " " + message.payload.substr(0, 200));
        auto again = message;
        const auto age = std::chrono::duration_cast<std::chrono::seconds>(now_ - at).count();
        if (again.expiry_seconds) *again.expiry_seconds -= static_cast<std::uint32_t>(age);
        broker_.replay(view.client(), again, now_);
    }

    void pass(Duration time) {
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

    /// All that is under way has arrived.
    void compare() {
        pass(kQuiet + judge_.settling() - kPromised);
        for (std::size_t i = 0; i < 2; ++i)
            compare_now(i);
    }
    void compare_now(std::size_t number) {
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
    void fail(const View& view, const std::string& board, const std::string& what, const Really& really) {
        end_.failure = fmt::format("{:.3f} s: {} (since {:.3f} s) {} {}; really: {} {} since {:.3f} s",
                                   seconds(now_), view.name(), seconds(view.started_at()), what, board,
                                   really.announced ? to_text(really.state) : "unknown",
                                   to_text(really.reason), seconds(really.since));
        note(end_.failure);
        if (!with_trace_) return;
        for (const auto& change : view.changes_of(board))
            note("told: " + change);
        for (const auto& word : truths_[board.back() - '0'].words)
            note("said: " + word.text + (word.unless_heard ? " (by an earlier session)" : ""));
    }

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

}  // namespace

End run_history(std::uint64_t seed, bool with_trace, const std::string& watched,
                std::vector<std::string>* recorded) {
    return History(seed, with_trace, watched, recorded).run();
}

}  // namespace truth::presence
