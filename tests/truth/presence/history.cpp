// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "tests/truth/presence/play.hpp"

namespace truth::presence {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPromisedOfBroker = 3s;  // all is right again, after the broker was away

class History : Play {
  public:
    using Play::Play;

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
        // Behind all else, so that the seeds of earlier failures play the same histories.
        const auto ends = [&](double chance) { return end_.failure.empty() && dice_.chance(chance); };
        if (ends(0.2)) contest();
        if (ends(0.1)) miss();
        ++end_.counts.histories;
        return std::move(end_);
    }

  private:
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
    void moment(std::int64_t longest) { pass(std::chrono::milliseconds(dice_.between(1, longest))); }
    void end_somehow(SimAgent& agent) {
        const auto how = dice_.below(3);
        constexpr const char* kHow[] = {"stopped", "killed", "cut off"};
        note("agent of " + agent.board() + " is " + kHow[how]);
        how == 0 ? agent.stop(now_) : how == 1 ? agent.kill(now_) : agent.cut_off(now_);
    }
    /// An agent comes back to a board that another one took, each of them ends as it may, and programs start
    /// or have the broker again beside that: what they were not there to hear is what the broker stores.
    void contest() {
        ++end_.counts.contests;
        const auto number = dice_.below(agents_.size());
        auto& first = *agents_[number];
        auto& second = *agents_[number ^ 1];
        if (!first.runs()) start(first);
        first.heal(now_);
        moment(5000);
        if (dice_.chance(0.7)) end_somehow(first);
        moment(2500);
        if (!second.runs()) start(second, dice_.between(0, 3000), dice_.chance(0.7));
        if (dice_.chance(0.2)) become(second, BoardState::kLost, StateReason::kSilent);
        if (dice_.chance(0.3)) moment(1500), lose_connection();
        moment(dice_.chance(0.5) ? 3000 : setting_.lease * 1200);
        if (first.is_cut_off()) note("the agent before it is back"), first.heal(now_);
        for (int i = 0; i < 2; ++i) {
            moment(i == 0 && dice_.chance(0.5) ? 100 : 1500);
            if (dice_.chance(0.7)) end_somehow(dice_.chance(0.5) ? first : second);
        }
        moment(dice_.chance(0.5) ? 1500 : setting_.lease * 1200);
        for (const auto& view : views_)
            if (!view->is_connected()) note(view->name() + " has it again"), view->connect(now_);
        join();
        compare();
        pass(std::chrono::seconds(setting_.lease));
        compare();
    }
    /// A program is away while a board that was gone comes back, with another agent or the same one, and is
    /// cut off.
    void miss() {
        ++end_.counts.misses;
        const auto number = dice_.below(agents_.size());
        auto& first = *agents_[number];
        auto& second = *agents_[number ^ (dice_.chance(0.7) ? 1 : 0)];
        auto& view = *views_[dice_.below(views_.size())];
        if (!first.runs()) start(first);
        first.heal(now_);
        moment(5000);
        become(first, BoardState::kOnline, StateReason::kNone);
        dice_.chance(0.7) ? end_somehow(first) : become(first, BoardState::kLost, StateReason::kUnplugged);
        moment(dice_.chance(0.5) ? 1500 : setting_.lease * 1500);
        if (view.is_connected()) note(view.name() + " is away"), view.disconnect(now_);
        moment(3000);
        if (!second.runs()) start(second);
        second.heal(now_);
        become(second, BoardState::kOnline, StateReason::kNone);
        moment(dice_.chance(0.5) ? 3000 : setting_.lease * 1500);
        note("agent of " + second.board() + " is cut off");
        second.cut_off(now_);
        moment(setting_.lease * 1500);
        if (!view.is_connected()) note(view.name() + " is back"), view.connect(now_);
        compare();
        moment(40'000);
        compare();
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
        if (again.expiry_seconds)
            *again.expiry_seconds -= std::min(*again.expiry_seconds, static_cast<std::uint32_t>(age));
        broker_.replay(view.client(), again, now_);
    }
};

}  // namespace

End run_history(std::uint64_t seed, bool with_trace, const std::string& watched,
                std::vector<std::string>* recorded) {
    return History(seed, with_trace, watched, recorded).run();
}

}  // namespace truth::presence
