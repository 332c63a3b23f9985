// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "tests/truth/presence/sim_agent.hpp"
#include "tests/truth/presence/views.hpp"

namespace truth::presence {
namespace {

using namespace std::chrono_literals;
using asip::model::to_text;

constexpr Time kBegin = Time{} + 1000s;
// A claim takes 1.3 s, a challenge as long, an answer to a probe 0.9 s.
constexpr Duration kQuiet = 5s;
// What happens is in every view within this time; a machine that is gone, after its lease; all, after the
// broker was away.
constexpr Duration kPromised = 1s;
constexpr Duration kPromisedOfLeases = 2s;
constexpr Duration kPromisedOfBroker = 3s;
// A registry judges no lease for so long after it heard the bus again.
constexpr Duration kGrace = 12s;
constexpr Duration kStep = 500ms;

class History {
  public:
    History(std::uint64_t seed, bool with_trace)
        : dice_(seed),
          in_order_(!dice_.chance(0.3)),
          says_state_(!in_order_ || dice_.chance(0.75)),
          lease_(static_cast<int>(dice_.chance(0.8) ? dice_.between(3, 10) : dice_.between(11, 40))),
          with_trace_(with_trace),
          broker_(dice_, in_order_) {
        note(fmt::format("seed {}: {}, {}, lease {} s", seed, in_order_ ? "in order" : "bridged brokers",
                         says_state_ ? "agents that say states" : "older agents", lease_));
        for (std::size_t i = 0; i < 2; ++i) {
            auto name = fmt::format("b{}", i);
            agents_.push_back(
                std::make_unique<SimAgent>(broker_, dice_, name, truths_[i], lease_, says_state_));
            agents_.push_back(
                std::make_unique<SimAgent>(broker_, dice_, name, truths_[i], lease_, says_state_));
        }
        views_.push_back(make_registry(broker_, dice_, "r1", now_));
        views_.push_back(make_gateway(broker_, dice_));
        views_.push_back(make_bus_view(broker_));
        for (auto& view : views_)
            view->start(now_);
    }

    End run() {
        // Many short ones find more than few long ones; what needs many actions is rare.
        const auto actions = dice_.chance(0.05) ? dice_.between(5, 12) : dice_.between(1, 4);
        for (std::int64_t i = 0; i < actions && end_.failure.empty(); ++i) {
            act();
            ++end_.counts.actions;
            pass(dice_.chance(0.5) ? std::chrono::milliseconds(dice_.between(1, 3000))
                                   : std::chrono::milliseconds(dice_.between(1, lease_ * 1500)));
            if (dice_.chance(0.2)) compare();
        }
        compare();
        ++end_.counts.histories;
        return std::move(end_);
    }

  private:
    void note(std::string what) {
        if (with_trace_)
            end_.trace.push_back(
                fmt::format("{:8.3f} {}", std::chrono::duration<double>(now_ - kBegin).count(), what));
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
        const bool takeover = dice_.chance(0.3);
        note(fmt::format("agent of {} starts, its clock off by {} s{}", agent.board(), skew,
                         takeover ? ", and takes over" : ""));
        agent.start(skew, takeover, now_);
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
        const bool certain =
            in_order_ && says_state_ && alone && agent.is_heard() && truths_[number].said.announced;
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
        if (!in_order_ || !says_state_) return;
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
                    : kind == 1 ? make_bus_view(broker_)
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
        if (!view.is_connected() || all.empty() || !says_state_) return;
        const auto& [at, message] = all[dice_.below(all.size())];
        const bool newest = message.topic.ends_with("/$description") &&
                            std::none_of(all.begin(), all.end(), [&](const auto& other) {
                                return other.second.topic == message.topic && other.first > at;
                            });
        const bool state = message.topic.ends_with("/$state");
        const auto described = last_description(message.topic.substr(16, 2));
        if (at < view.connected_at() || newest || (state && at + 4s > described)) return;
        note("replayed to " + view.name() + ": " + message.topic + " of " +
             fmt::format("{:.3f}", std::chrono::duration<double>(at - kBegin).count()) + " " +
             message.payload.substr(0, 200));
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

    /// What came in another order is put right by the next renewal.
    Duration settling() const {
        return in_order_ ? kPromised : kPromised + std::chrono::milliseconds(lease_ * 400);
    }
    /// All that is under way has arrived.
    void compare() {
        pass(kQuiet + settling() - kPromised);
        for (std::size_t i = 0; i < 2; ++i)
            compare_now(i);
    }
    void compare_now(std::size_t number) {
        const auto name = fmt::format("b{}", number);
        for (const auto& view : views_) {
            if (view->is_connected()) compare(*view, name, truths_[number]);
            if (in_order_ && says_state_) compare_changes(*view, name, truths_[number]);
        }
    }
    /// Each change is told once: what a registry tells is what was said, in that order, and the ends of
    /// leases.
    void compare_changes(const View& view, const std::string& name, const BoardTruth& truth) {
        const auto changes = view.changes_of(name);
        auto said = truth.words.begin();
        for (std::size_t i = 0; i < changes.size() && end_.failure.empty(); ++i) {
            const bool twice = i > 0 && changes[i] == changes[i - 1];
            if (!twice && changes[i] == "lost expired") continue;
            said = std::find(said, truth.words.end(), changes[i]);
            if (twice || said == truth.words.end())
                return fail(view, name, "told too often that it is " + changes[i] + ":", truth.really(now_));
        }
    }

    void compare(View& view, const std::string& name, const BoardTruth& truth) {
        const Really really = truth.really(now_);
        if (!end_.failure.empty()) return;
        // A change that is still under way, or a will that its agent puts right.
        if (now_ - really.since < kPromised || now_ - truth.last_will < settling()) return;
        const auto seen = view.board(name, now_);
        if (!view.is_complete()) {
            // Another registry that does not answer is waited for.
            if (now_ - view.connected_at() > 15s) fail(view, name, "is not complete", really);
            return;
        }
        ++end_.counts.comparisons;
        if (!really.announced) {
            if (seen) fail(view, name, "has a board that never announced itself", really);
            return;
        }
        // A lease that ran out is judged when the program had time to hear of a renewal.
        const bool judged = really.reason == StateReason::kExpired;
        const bool heard_bus = view.connected_at() + kGrace < really.since;
        if (judged && now_ - (heard_bus ? really.since : view.connected_at()) <
                          (heard_bus ? kPromisedOfLeases : kGrace))
            return;
        if (!seen) return fail(view, name, "has no such board", really);
        if (seen->state != to_text(really.state)) return fail(view, name, "says " + seen->state, really);
        // Of an agent that is gone for longer than a lease the broker has the word of the state alone.
        const bool knows_why =
            says_state_ &&
            (view.heard(really.since) ||
             (!judged && (view.connected_at() < last_description(name) + std::chrono::seconds(lease_) ||
                          broker_.stores("asip/servicebus/" + name + "/$description", now_))));
        if (!knows_why) return;
        const bool in_conflict = seen->reason == "conflict" && really.reason == StateReason::kNone;
        if (seen->reason != to_text(really.reason) && !in_conflict)
            return fail(view, name, "says " + seen->state + " " + seen->reason, really);
        const auto tolerance = judged && !heard_bus ? kGrace : in_order_ ? Duration(2s) : Duration(3s);
        const auto difference = seen->since - instant(really.since).wall;
        if (difference > tolerance || difference < -tolerance)
            fail(view, name,
                 fmt::format("says {} since {:.3f} s", seen->state,
                             std::chrono::duration<double>(seen->since - instant(kBegin).wall).count()),
                 really);
    }

    Time last_description(const std::string& board) const {
        Time last{};
        for (const auto& [at, message] : broker_.published())
            if (message.topic == "asip/servicebus/" + board + "/$description") last = at;
        return last;
    }

    void fail(const View& view, const std::string& board, const std::string& what, const Really& really) {
        end_.failure =
            fmt::format("{:.3f} s: {} (since {:.3f} s) {} {}; really: {} {} since {:.3f} s",
                        std::chrono::duration<double>(now_ - kBegin).count(), view.name(),
                        std::chrono::duration<double>(view.started_at() - kBegin).count(), what, board,
                        really.announced ? to_text(really.state) : "unknown", to_text(really.reason),
                        std::chrono::duration<double>(really.since - kBegin).count());
        note(end_.failure);
        if (!with_trace_) return;
        for (const auto& change : view.changes_of(board))
            note("told: " + change);
        for (const auto& word : truths_[board.back() - '0'].words)
            note("said: " + word);
    }

    Dice dice_;
    bool in_order_;
    bool says_state_;
    int lease_;
    bool with_trace_;
    End end_;
    Time now_ = kBegin;
    Time next_tick_ = kBegin;
    int registries_ = 1;
    SimBroker broker_;
    BoardTruth truths_[2];
    std::vector<std::unique_ptr<SimAgent>> agents_;
    std::vector<std::unique_ptr<View>> views_;
};

}  // namespace

End run_history(std::uint64_t seed, bool with_trace) {
    return History(seed, with_trace).run();
}

}  // namespace truth::presence
