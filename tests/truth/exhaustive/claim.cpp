// SPDX-License-Identifier: Apache-2.0
// Two agents claim one name: every order in which their first messages can arrive, for every distance of
// their starts, clock, random number and moment of a death within a bound. One of them has the name at the
// end.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asip/member/announcer.hpp"

namespace {

using namespace std::chrono_literals;
using asip::Duration;
using asip::Time;
using asip::member::Announcements;
using asip::member::Announcer;
using asip::mqtt::Message;

constexpr const char* kBoard = "uno1";
constexpr std::uint64_t kStarted = 1'790'000'000;
constexpr Time kBegin = Time{} + 1h;
// Between an agent and another, by the broker. A claim waits 1.3 s: 1 s for an answer to a probe, and its
// ways.
constexpr Duration kSlow = 100ms;
// The longest that matters, a challenge behind an announcement, and a good while.
constexpr Duration kSettled = 10s;

struct Case {
    Duration apart{};   // the start of the second behind that of the first
    int clock = 0;      // of the second, in seconds
    unsigned late = 0;  // bits: whose answers to probes come as late as they may
    bool takeover = false;
    std::optional<std::pair<unsigned, Duration>> death;  // which agent is killed, and when, from the second's
                                                         // start
    unsigned slow = 0;                                   // bits: which of the first messages are slow
};

std::string describe(const Case& one) {
    const auto ms = [](Duration time) {
        return std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
    };
    auto text = fmt::format("second {} ms later, its clock {:+} s, late {:b}, slow {:b}{}", ms(one.apart),
                            one.clock, one.late, one.slow, one.takeover ? ", takes over" : "");
    if (one.death) text += fmt::format(", {} killed after {} ms", one.death->first, ms(one.death->second));
    return text;
}

class World {
  public:
    explicit World(const Case& one) : case_(one) {}

    /// What is wrong; empty: nothing.
    std::string run() {
        now_ = kBegin;
        start(0, 0);
        const Time second = kBegin + case_.apart;
        pass_until(second);
        start(1, case_.clock);
        if (case_.death) {
            pass_until(second + case_.death->second);
            kill(case_.death->first);
        }
        pass_until(now_ + kSettled);
        return check();
    }
    std::uint64_t messages() const { return number_; }

  private:
    struct Arrival {
        Time due;
        Message message;
    };
    struct Agent {
        std::optional<Announcer> announcer;
        std::string started_as;
        std::deque<Arrival> arrivals;
        bool ended = false;
        bool killed = false;
    };

    void start(unsigned which, int clock) {
        asip::member::AnnouncerOptions options;
        options.board = kBoard;
        options.takeover = which == 1 && case_.takeover;
        const auto age = std::chrono::duration_cast<std::chrono::seconds>(now_ - kBegin).count();
        options.started_unix = static_cast<std::uint64_t>(static_cast<std::int64_t>(kStarted) + age + clock);
        const std::uint64_t rest = (case_.late >> which & 1) != 0 ? UINT64_MAX : 0;
        auto& agent = agents_[which];
        // The first six draws name the session; the two differ.
        agent.announcer.emplace(topics_, options, [rest, which, n = 0]() mutable {
            return n++ < 6 ? (which + 1ULL) << 60 : rest;
        });
        asip::model::Description description;
        description.services.resize(1);
        description.services[0].name = "io";
        agent.announcer->describe(std::move(description));
        for (const auto& stored : {state_, description_})
            if (stored) {
                auto message = *stored;
                message.retain = true;
                agent.arrivals.push_back({now_ + 1ms, std::move(message)});
            }
        Announcements out;
        agent.announcer->set_state(asip::model::BoardState::kOnline, asip::model::StateReason::kNone, now_,
                                   out);
        agent.announcer->on_connected(now_, out);
        agent.announcer->on_subscribed(now_, out);
        perform(which, out);
    }

    void kill(unsigned which) {
        auto& agent = agents_[which];
        if (agent.ended) return;
        agent.killed = agent.ended = true;
        agent.arrivals.clear();
        publish(which, agent.announcer->will());
    }

    // The first of what may come next; at the same time the first agent's.
    void pass_until(Time end) {
        while (true) {
            Time next = end;
            std::optional<unsigned> who;
            bool arrives = false;
            for (unsigned i = 0; i < 2; ++i) {
                auto& agent = agents_[i];
                if (!agent.announcer || agent.ended) continue;
                if (!agent.arrivals.empty() && agent.arrivals.front().due < next)
                    next = agent.arrivals.front().due, who = i, arrives = true;
                if (const auto due = agent.announcer->next_deadline(); due && *due < next)
                    next = *due, who = i, arrives = false;
            }
            now_ = std::max(now_, next);
            if (!who) return;
            Announcements out;
            auto& agent = agents_[*who];
            if (arrives) {
                const Message message = std::move(agent.arrivals.front().message);
                agent.arrivals.pop_front();
                agent.announcer->on_message(message, now_, out);
            } else {
                agent.announcer->tick(now_, out);
            }
            perform(*who, out);
        }
    }

    void perform(unsigned which, Announcements& out) {
        for (auto& publication : out.publish)
            publish(which, std::move(publication.message));
        if (!out.fatal) return;
        agents_[which].ended = true;
        agents_[which].arrivals.clear();
    }

    void publish(unsigned from, Message message) {
        const bool is_state = message.topic == topics_.state(kBoard);
        const bool is_description = message.topic == topics_.description(kBoard);
        if (!is_state && !is_description && message.topic != topics_.probe()) return;
        if (message.retain) (is_state ? state_ : description_) = message;
        message.retain = false;
        for (unsigned to = 0; to < 2; ++to) {
            auto& agent = agents_[to];
            if (!agent.announcer || agent.ended || (to == from && !is_state)) continue;
            const bool slow = number_ < 32 && (case_.slow >> number_ & 1) != 0;
            ++number_;
            Time due = now_ + (slow ? kSlow : Duration(1ms));
            if (!agent.arrivals.empty()) due = std::max(due, agent.arrivals.back().due);
            agent.arrivals.push_back({due, message});
        }
    }

    std::string check() const {
        std::vector<unsigned> holders;
        for (unsigned i = 0; i < 2; ++i)
            if (!agents_[i].ended && agents_[i].announcer->established()) holders.push_back(i);
        const bool waits = std::any_of(agents_.begin(), agents_.end(), [](const Agent& one) {
            return !one.ended && !one.announcer->established();
        });
        const bool killed = agents_[0].killed || agents_[1].killed;
        if (waits) return "an agent runs and has no name";
        if (holders.size() > 1) return "both have the name";
        // The other had given way before the one that it gave way to was killed.
        if (holders.empty()) return killed ? "" : "none has the name";
        // The later session of two that claim at the same time has it.
        if (case_.takeover && case_.apart > 1500ms && !killed && holders[0] != 1)
            return "the name was not taken over";
        const auto& holder = *agents_[holders[0]].announcer;
        if (!state_ || state_->payload != "online")
            return "the stored state is not that of the one that has the name";
        if (!description_ || description_->payload.find(holder.session()) == std::string::npos)
            return "the stored description is not that of the one that has the name";
        return {};
    }

    const Case& case_;
    asip::bus::Topics topics_;
    std::array<Agent, 2> agents_;
    std::optional<Message> state_, description_;  // as the broker stores them
    Time now_;
    std::uint64_t number_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Checks that of two agents that claim one name one has it at the end.");
    unsigned failures_allowed = 10;
    unsigned varied = 6;
    app.add_option("--messages", varied, "So many messages, from the first on, are quick or slow")
        ->check(CLI::Range(0, 16))
        ->capture_default_str();
    app.add_option("--failures", failures_allowed, "Stop after so many failures")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    std::vector<std::optional<std::pair<unsigned, Duration>>> deaths{std::nullopt};
    for (unsigned which = 0; which < 2; ++which)
        for (const Duration after :
             {Duration(0ms), Duration(50ms), Duration(150ms), Duration(1250ms), Duration(1305ms),
              Duration(1450ms), Duration(2350ms), Duration(2700ms), Duration(5s)})
            deaths.emplace_back(std::pair{which, after});
    std::uint64_t worlds = 0;
    std::uint64_t messages = 0;
    unsigned failures = 0;
    Case one;
    for (const Duration apart : {Duration(0ms), Duration(20ms), Duration(150ms), Duration(1200ms),
                                 Duration(1295ms), Duration(1310ms), Duration(2s), Duration(30s)})
        for (const int clock : {0, -3600, 3600})
            for (const bool takeover : {false, true})
                for (const auto& death : deaths)
                    for (unsigned late = 0; late < 4; ++late)
                        for (unsigned slow = 0; slow < 1U << varied && failures < failures_allowed; ++slow) {
                            one = {apart, clock, late, takeover, death, slow};
                            World world(one);
                            const auto wrong = world.run();
                            ++worlds;
                            messages += world.messages();
                            if (wrong.empty()) continue;
                            ++failures;
                            fmt::print("FAILED: {}: {}\n", describe(one), wrong);
                        }
    fmt::print("{} histories of two agents and one name, {} messages; {} wrong\n", worlds, messages,
               failures);
    return failures == 0 && worlds > 0 ? 0 : 1;
}
