// SPDX-License-Identifier: Apache-2.0
// A board whose cable is pulled, for longer than anything that could bring it back by mistake: real broker,
// firmware, agent, registries and asipctl.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::IsEmpty;

constexpr auto kLease = std::chrono::seconds(3);

struct View {
    std::string state;
    std::string reason;
    bool operator==(const View&) const = default;
};
void PrintTo(const View& view, std::ostream* out) {
    *out << view.state << " (" << view.reason << ")";
}

class Presence : public testing::Test {
  protected:
    std::unique_ptr<ChildProcess> start_registry(const std::string& id) {
        auto registry = std::make_unique<ChildProcess>(std::vector<std::string>{
            ASIP_PROGRAMS "/asip-registry", "--broker", broker.address(), "--id", id});
        EXPECT_TRUE(registry->wait_for_errors("catalogue is complete")) << registry->errors();
        return registry;
    }
    void run_asipctl(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), ASIP_PROGRAMS "/asipctl");
        arguments.insert(arguments.end(), {"--broker", broker.address()});
        ChildProcess program(std::move(arguments));
        EXPECT_TRUE(program.wait_exit()) << program.errors();
        answered_ = program.output();
    }
    View by_registry(const std::string& id) {
        const auto answer =
            json::parse(probe.request("asip/registry/" + id + "/query", R"({"find":"boards","board":"uno1"})")
                            .value_or("{}"));
        const auto boards = answer.value("items", json::array());
        if (boards.empty()) return {"unknown", ""};
        return {boards[0].value("state", ""), boards[0].value("reason", "")};
    }
    View by_asipctl_without_registry() {
        run_asipctl({"list", "--from-bus", "-o", "json"});
        const auto boards = json::parse(answered_, nullptr, false);
        if (!boards.is_array() || boards.empty()) return {"unknown", ""};
        return {boards[0].value("state", ""), boards[0].value("reason", "")};
    }
    std::vector<std::string> states_told(const std::string& id) const {
        std::vector<std::string> states;
        for (const auto& message : probe.messages("asip/registry/" + id + "/events")) {
            const auto event = json::parse(message.payload);
            if (event.value("event", "") == "state") states.push_back(event["board"].value("state", ""));
        }
        return states;
    }

    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe{broker.port(), {"asip/#"}};
    std::string answered_;
};

TEST_F(Presence, CablePulled_EachViewSaysLostForLeasesAndProbesAndLateJoiners) {
    auto first = start_registry("r1");
    Agent agent(broker, uno.port(), {"--lease", std::to_string(kLease.count())});
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    ASSERT_TRUE(wait_until([&] { return by_registry("r1").state == "online"; }));
    uno.command("unplug");
    const auto pulled = Clock::now();
    const View lost{"lost", "unplugged"};
    ASSERT_TRUE(wait_until([&] { return by_registry("r1") == lost; })) << agent.process().errors();
    EXPECT_LT(Clock::now() - pulled, time_limit(1s));
    std::unique_ptr<ChildProcess> late;
    while (Clock::now() - pulled < 4 * kLease) {
        ASSERT_EQ(by_registry("r1"), lost);
        if (Clock::now() - pulled > kLease && !late) late = start_registry("r2");
        if (late) {
            ASSERT_EQ(by_registry("r2"), lost);
        }
        ASSERT_EQ(by_asipctl_without_registry(), lost);
        run_asipctl({"doctor"});
    }
    ASSERT_TRUE(late);
    EXPECT_THAT(states_told("r1"), testing::ElementsAre("lost")) << "one event for one change";
    EXPECT_THAT(states_told("r2"), IsEmpty());
    uno.command("replug");
    ASSERT_TRUE(wait_until([&] { return by_registry("r1") == View{"online", ""}; }))
        << agent.process().errors();
    EXPECT_TRUE(wait_until([&] { return by_registry("r2") == View{"online", ""}; }));
}

}  // namespace
}  // namespace asip::test
