// SPDX-License-Identifier: Apache-2.0
// The truth test of presence with everything real: firmware in simavr, agent, Mosquitto, two registries, a
// gateway and asipctl. Cables are pulled, agents killed, stopped and started, programs and the broker
// restarted; what each view says is compared with what was done, at once and for longer than a lease.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "asip/time.hpp"
#include "tests/integration/agent/rig.hpp"
#include "tests/integration/gateway/running_gateway.hpp"
#include "tests/support/dice.hpp"
#include "tests/truth/presence/machine.hpp"

namespace {

using namespace std::chrono_literals;
using asip::Clock;
using asip::Duration;
using asip::Time;
using asip::test::ChildProcess;
using nlohmann::json;

constexpr int kLease = 4;  // seconds

struct Said {
    std::string state, reason;
    bool operator==(const Said&) const = default;
};

std::string text(const Said& said) {
    return said.reason.empty() ? said.state : said.state + " (" + said.reason + ")";
}

Said of_item(const json& item) {
    return {item.value("state", ""), item.value("reason", "")};
}

class Round {
  public:
    explicit Round(std::uint64_t seed) : dice_(seed) {
        start_registry(0);
        start_registry(1);
        gateway_.emplace(broker_.address());
        start_agent();
        expect({"online", ""}, 20s, "the agent starts");
    }

    void run(std::int64_t actions) {
        for (std::int64_t i = 0; i < actions; ++i) {
            act();
            hold(dice_.chance(0.5) ? 500ms : std::chrono::milliseconds(dice_.between(1000, kLease * 2500)));
        }
    }
    unsigned comparisons() const { return comparisons_; }
    unsigned failures() const { return failures_; }
    unsigned starved() const { return starved_; }
    double slowest() const { return slowest_; }

  private:
    void start_registry(std::size_t i) {
        registries_[i].reset();
        registries_[i] = std::make_unique<ChildProcess>(
            std::vector<std::string>{ASIP_PROGRAMS "/asip-registry", "--broker", broker_.address(), "--id",
                                     "r" + std::to_string(i + 1)});
        registries_[i]->wait_for_errors("catalogue is complete");
    }
    void start_agent() {
        agent_.emplace(broker_, uno_.port(),
                       std::vector<std::string>{"--lease", std::to_string(kLease), "--takeover"});
        runs_ = true;
    }

    void act() {
        switch (dice_.below(8)) {
            case 0:
            case 1:
                return plugged_ ? unplug() : plug();
            case 2:
                return runs_ ? kill_agent() : restart_agent();
            case 3:
                return runs_ ? stop_agent() : restart_agent();
            case 4:
                start_registry(dice_.below(2));
                return expect(really_, 3s, "a registry starts");
            case 5:
                gateway_.reset();
                gateway_.emplace(broker_.address());
                return expect(really_, 3s, "a gateway starts");
            case 6:
                probe_->publish("asip/servicebus/$probe", "");
                return expect(really_, 2s, "a probe");
            default:
                broker_.restart();
                probe_.emplace(broker_.port(), std::vector<std::string>{"asip/#"});
                return expect(really_, 6s, "the broker restarts");
        }
    }
    void unplug() {
        uno_.command("unplug");
        plugged_ = false;
        if (runs_) expect({"lost", "unplugged"}, 1s, "the cable is pulled");
    }
    void plug() {
        uno_.command("replug");
        plugged_ = true;
        if (runs_) expect({"online", ""}, 12s, "the cable is back");
    }
    void kill_agent() {
        agent_->kill();
        runs_ = false;
        expect(plugged_ ? Said{"lost", "agent-gone"} : really_, 1s, "the agent is killed");
    }
    void stop_agent() {
        agent_->process().signal(SIGTERM);
        agent_->process().wait_exit();
        runs_ = false;
        expect({"offline", "stopped"}, 1s, "the agent is stopped");
    }
    /// One that finds no board says nothing of it.
    void restart_agent() {
        if (!plugged_) {
            uno_.command("replug");
            plugged_ = true;
        }
        start_agent();
        expect({"online", ""}, 20s, "the agent starts");
    }

    /// No answer is not a wrong one: it is asked again for as long, in time of the machine.
    Said by_registry(const std::string& id) {
        constexpr auto kLimit = 2s;
        const Time began = Clock::now();
        std::optional<std::string> text;
        do {
            text = probe_->request("asip/registry/" + id + "/query", R"({"find":"boards","board":"uno1"})",
                                   kLimit);
        } while (!text && machine_.pace().passed(began, Clock::now()) < kLimit);
        if (!text) return {"no answer", ""};
        const auto answer = json::parse(*text, nullptr, false);
        const auto items = answer.is_object() ? answer.value("items", json::array()) : json::array();
        return items.empty() ? Said{"unknown", *text} : of_item(items[0]);
    }
    Said by_gateway() {
        const auto answer = asip::test::get(gateway_->port(), "/api/boards/uno1").json();
        return answer.is_object() ? of_item(answer) : Said{"unknown", ""};
    }
    Said by_asipctl() {
        ChildProcess program(
            {ASIP_PROGRAMS "/asipctl", "list", "--from-bus", "-o", "jsonl", "--broker", broker_.address()});
        program.wait_exit();
        const auto answer = json::parse(program.output(), nullptr, false);
        return answer.is_object() ? of_item(answer) : Said{"unknown", ""};
    }

    /// Each view says so within `limit`, which is a time of the machine: a busy one takes longer.
    void expect(const Said& wanted, Duration limit, const std::string& after) {
        really_ = wanted;
        const Time began = Clock::now();
        std::string wrong;
        do {
            wrong = difference(false);
        } while (!wrong.empty() && !machine_.pace().had_time(began, limit, Clock::now()));
        const double took =
            std::chrono::duration<double>(machine_.pace().passed(began, Clock::now())).count();
        slowest_ = std::max(slowest_, took / std::chrono::duration<double>(limit).count());
        if (!wrong.empty()) fail(after, wrong);
    }
    /// And goes on saying so. Programs that got no processor answer late, and renew late what a lease ends:
    /// that is put right when they get it.
    void hold(Duration time) {
        for (const Time until = Clock::now() + time; Clock::now() < until;) {
            const Time asked = Clock::now();
            const auto wrong = difference(true);
            if (wrong.empty()) continue;
            if (!machine_.pace().starved(asked - std::chrono::seconds(kLease), Clock::now()))
                return fail("all is quiet", wrong);
            ++starved_;
            expect(really_, 3s, "the machine was busy");
        }
    }
    /// The first view that says something else. After the lease of an agent that is gone the broker has the
    /// word of the state alone.
    std::string difference(bool with_asipctl) {
        const std::string names[] = {"r1", "r2"};
        for (const auto& name : names)
            if (const auto said = by_registry(name); !same(said))
                return "registry " + name + ": " + text(said);
        if (const auto said = by_gateway(); !same(said)) return "gateway: " + text(said);
        if (with_asipctl) {
            if (const auto said = by_asipctl(); !same(said)) return "asipctl: " + text(said);
        }
        comparisons_ += 3;
        return {};
    }
    bool same(const Said& said) const { return runs_ ? said == really_ : said.state == really_.state; }

    void fail(const std::string& after, const std::string& wrong) {
        ++failures_;
        fmt::print("FAILED: {}: {}; really {}\n", after, wrong, text(really_));
        std::fflush(stdout);
    }

    asip::test::Dice dice_;
    asip::test::MosquittoBroker broker_{{.persistence = true}};
    asip::test::SimulatedUno uno_;
    std::optional<asip::test::BusProbe> probe_{std::in_place, broker_.port(),
                                               std::vector<std::string>{"asip/#"}};
    std::unique_ptr<ChildProcess> registries_[2];
    std::optional<asip::test::RunningGateway> gateway_;
    std::optional<asip::test::Agent> agent_;
    bool plugged_ = true;
    bool runs_ = false;
    Said really_;
    unsigned comparisons_ = 0;
    unsigned failures_ = 0;
    unsigned starved_ = 0;
    double slowest_ = 0;
    truth::Machine machine_;
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Checks what real programs say of a real firmware's presence.");
    std::uint64_t first = 1;
    double seconds = 60;
    std::int64_t actions = 10;
    app.add_option("--first", first, "Seed of the first round")->capture_default_str();
    app.add_option("--seconds", seconds, "Rounds until then")->capture_default_str();
    app.add_option("--actions", actions, "In a round")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    const auto until =
        Clock::now() + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
    unsigned failures = 0;
    for (std::uint64_t seed = first; seed == first || Clock::now() < until; ++seed) {
        Round round(seed);
        round.run(actions);
        fmt::print(
            "seed {}: {} comparisons, slowest {:.1f} times what is promised, {} late on a starved machine, "
            "{} wrong\n",
            seed, round.comparisons(), round.slowest(), round.starved(), round.failures());
        std::fflush(stdout);
        failures += round.failures();
    }
    return failures == 0 ? 0 : 1;
}
