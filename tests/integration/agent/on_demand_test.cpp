// SPDX-License-Identifier: Apache-2.0
// An agent that makes its board report on demand: real broker, agent, asipctl and firmware.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string kValues = "asip/uno1/distance/out";

class ReportsOnDemand : public testing::Test {
  protected:
    void start_agent(const std::string& settings = {}) {
        const std::vector<std::string> more{"--reports", "on-demand", "--takeover", "--config",
                                            settings_file("statistics = 500ms\n" + settings)};
        agent = std::make_unique<Agent>(broker, uno.port(), more);
        ASSERT_TRUE(wait_state(probe, "online")) << agent->process().errors();
    }
    std::unique_ptr<ChildProcess> subscriber(const std::string& hz) {
        return std::make_unique<ChildProcess>(
            std::vector<std::string>{ASIP_PROGRAMS "/asipctl", "subscribe", "uno1/distance", "--max-hz", hz,
                                     "--broker", broker.address(), "--from-bus"});
    }
    /// The agent says that the distance is reported at this period.
    bool period_becomes(int wanted, std::chrono::milliseconds limit = kDeadline) {
        return wait_until([&] { return period() == wanted; }, limit);
    }
    int period() const { return demand_statistics().value("periods", json::object()).value("distance", -1); }
    std::size_t values_within(std::chrono::milliseconds time) {
        const auto before = probe.count(kValues);
        wait_until([] { return false; }, time);
        return probe.count(kValues) - before;
    }
    json demand_statistics() const {
        return json::parse(probe.last("asip/servicebus/uno1/$stats").value_or("{}"))
            .value("demand", json::object());
    }

    // A flood waits at the broker for an agent that is not run for a moment.
    MosquittoBroker broker{{.extra_lines = {"max_queued_messages 0"}}};
    SimulatedUno uno;
    BusProbe probe{broker.port(), {"asip/#"}};
    std::unique_ptr<Agent> agent;
};

// Takes as long as a lease of asipctl: nothing but time shows that no client renews it.
TEST_F(ReportsOnDemand, RateFollowsTheFastestSubscriber_AndEndsWithTheLease) {
    start_agent();
    ASSERT_TRUE(period_becomes(0)) << agent->process().errors();
    EXPECT_LE(values_within(1s), 1u) << "nobody listens";

    auto slow = subscriber("2");
    ASSERT_TRUE(period_becomes(500)) << slow->errors() << agent->process().errors();
    ASSERT_TRUE(slow->wait_for_output("cm"));
    auto fast = subscriber("20");
    ASSERT_TRUE(period_becomes(50)) << fast->errors();
    EXPECT_GE(values_within(2s), 12u);

    fast->signal(SIGKILL);
    fast->wait_exit();
    ASSERT_TRUE(period_becomes(500, time_limit(25s))) << "its lease is over";
    EXPECT_LE(values_within(2s), 6u);

    uno.command("reset");
    ASSERT_TRUE(agent->process().wait_for_errors("board back")) << agent->process().errors();
    probe.clear();
    EXPECT_TRUE(probe.wait_for(kValues)) << "the period is set again";

    slow->signal(SIGINT);
    EXPECT_EQ(slow->wait_exit(), 0);
    ASSERT_TRUE(wait_until([&] { return values_within(800ms) == 0; }, time_limit(15s)))
        << agent->process().errors();
}

TEST_F(ReportsOnDemand, PlainClients_GetTheRestingPeriod_AndPeopleSeeIt) {
    start_agent("resting-period = 400ms\nfastest-period = 100ms\n");
    ASSERT_TRUE(period_becomes(400)) << agent->process().errors();
    EXPECT_TRUE(probe.wait_for(kValues)) << "the probe demands nothing";
    auto fast = subscriber("1000");
    ASSERT_TRUE(period_becomes(100));
    const auto shown = run({ASIP_PROGRAMS "/asipctl", "show", "uno1", "--broker", broker.address()});
    EXPECT_THAT(
        shown.output,
        HasSubstr("on demand, every 100 ms at the fastest; every 400 ms while no program subscribes"));
    ASSERT_TRUE(probe.request("asip/uno1/distance/in", R"({"report":50})"));
    EXPECT_TRUE(period_becomes(50)) << "a command is not bound by the options";
    const auto nonsense = run({ASIP_PROGRAMS "/asip-agent", "--serial", uno.port(), "--config",
                               settings_file("fastest-period = 0s\n")});
    EXPECT_EQ(nonsense.status, 2);
    EXPECT_THAT(nonsense.errors, HasSubstr("fastest-period: 0s is not 1 ms to 65535 ms"));
}

TEST_F(ReportsOnDemand, FloodOfTenThousandDemanders_IsBoundedAndHoldsUpNobody) {
    start_agent();
    ASSERT_TRUE(period_becomes(0));
    const auto before = agent->process().resident_bytes();
    BusProbe mallory(broker.port(), {});
    for (int i = 0; i < 10'000; ++i)
        mallory.publish("asip/servicebus/uno1/$demand/mallory/" + std::to_string(i),
                        R"({"services":{"*":1e308},"lease":60})", false, 0);
    for (const char* rubbish : {"", "{", "NaN", R"({"services":{"distance":NaN}})", "[[[[[[[[[[[[[[[[["})
        mallory.publish("asip/servicebus/uno1/$demand/mallory/x", rubbish);
    EXPECT_TRUE(wait_until([&] {
        const auto answer = probe.request("asip/uno1/io/in", R"({"mode":[13,"output"]})", time_limit(5s));
        return answer && answer->find("fence") != std::string::npos;  // a starved board may leave a doubt
    })) << agent->process().errors();
    ASSERT_TRUE(period_becomes(20)) << agent->process().errors();
    ASSERT_TRUE(wait_until([&] { return demand_statistics().value("rejected", 0) >= 8'900; }))
        << demand_statistics();
    EXPECT_EQ(demand_statistics()["demanders"], 1024);
    EXPECT_LE(demand_statistics()["changes"], 16);
    EXPECT_LE(agent->process().resident_bytes(), before + memory_limit(4 << 20));

    mallory.publish("asip/servicebus/uno1/$demand/ann/c1", R"({"services":{"distance":1}})");
    EXPECT_TRUE(wait_until([&] { return probe.count("asip/servicebus/uno1/$demand/ann/c1") == 1; }));
}

}  // namespace
}  // namespace asip::test
