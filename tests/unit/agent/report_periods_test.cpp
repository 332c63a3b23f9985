// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/report_periods.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;
using Lines = std::vector<std::string>;

TEST(PeriodFor, Rate_IsAtMostWhatIsDemanded_WithinItsBounds) {
    EXPECT_EQ(period_for(10, 20, 65535), 100u);
    EXPECT_EQ(period_for(3, 20, 65535), 334u);
    EXPECT_EQ(period_for(1000, 20, 65535), 20u);
    EXPECT_EQ(period_for(1e308, 20, 65535), 20u);
    EXPECT_EQ(period_for(std::numeric_limits<double>::infinity(), 20, 65535), 20u);
    EXPECT_EQ(period_for(.001, 20, 65535), 65535u);
    EXPECT_EQ(period_for(5e-324, 20, 65535), 65535u);
    EXPECT_EQ(period_for(10, 200, 50), 50u) << "a model whose slowest is faster than that";
    EXPECT_EQ(period_for(0, 20, 65535), 0u);
    EXPECT_EQ(period_for(-1, 20, 65535), 0u);
    EXPECT_EQ(period_for(std::nan(""), 20, 65535), 0u);
}

BridgeOptions on_demand(std::chrono::milliseconds resting = 0ms) {
    auto options = BridgeBench::defaults();
    options.reports = {true, 20ms, resting};
    return options;
}

struct OnDemand : testing::Test {
    explicit OnDemand(BridgeOptions options = on_demand()) : bench(std::move(options)) { bench.go_online(); }

    void demand(const std::string& text, const std::string& demander = "ann/c1", bool retained = false) {
        bench.hear("asip/servicebus/uno1/$demand/" + demander, text, retained);
    }
    /// What was sent to the board within `time`.
    Lines sent(Duration time = 0s) {
        bench.pass(time);
        return std::exchange(bench.board.executed, {});
    }
    nlohmann::json statistics() {
        bench.publish_statistics();
        return nlohmann::json::parse(bench.on("asip/servicebus/uno1/$stats").back())["demand"];
    }
    nlohmann::json described() {
        bench.pass(1500ms);
        return nlohmann::json::parse(bench.on("asip/servicebus/uno1/$description").back());
    }
    BridgeBench bench;
};

TEST_F(OnDemand, BoardThatIsFound_IsSilentUntilSomebodyDemands) {
    EXPECT_THAT(sent(), UnorderedElementsAre("D,A,0", "I,A,0"));
    const auto description = described();
    EXPECT_EQ(description["on_demand"], nlohmann::json::parse(R"({"fastest":20,"resting":0})"));
    EXPECT_FALSE(description["services"][2].contains("period")) << "it would change with each subscriber";
    EXPECT_EQ(statistics()["periods"], nlohmann::json::parse(R"({"distance":0,"io":0})"));
    EXPECT_THAT(bench.bridge.control_subscriptions(),
                Contains(testing::Field(&member::Announcer::Subscription::filter,
                                        "asip/servicebus/uno1/$demand/+/+")));
}

TEST_F(OnDemand, Period_FollowsTheFastestOfSeveral_AndEndsAfterTheLast) {
    sent(2s);
    demand(R"({"services":{"distance":2},"lease":60})");
    EXPECT_THAT(sent(), ElementsAre("D,A,500"));
    demand(R"({"services":{"distance":20},"lease":5})", "bob/c7");
    EXPECT_THAT(sent(1s), ElementsAre("D,A,50"));
    EXPECT_THAT(sent(8s), ElementsAre("D,A,500")) << "the lease of the second is over";
    demand(R"({"services":{}})");
    EXPECT_THAT(sent(2s), IsEmpty());
    EXPECT_THAT(sent(2s), ElementsAre("D,A,0"));
    EXPECT_EQ(statistics()["periods"]["distance"], 0);
    bench.published.clear();
    demand(R"({"services":{"distance":5}})");
    bench.pass(5s);
    EXPECT_THAT(bench.on("asip/servicebus/uno1"), IsEmpty()) << "that is no news to announce";
}

TEST_F(OnDemand, Changes_AreOneASecondOfAService_HoweverManyDemands) {
    sent(2s);
    for (int i = 1; i <= 1000; ++i) {
        demand(R"({"services":{"*":)" + std::to_string(i) + "}}", "ann/" + std::to_string(i));
        bench.pass(5ms);
    }
    EXPECT_LE(sent(0s).size(), 2u * 7u);
    EXPECT_THAT(sent(2s), Not(Contains("D,A,1")));
    EXPECT_EQ(statistics()["periods"]["distance"], 20);
}

TEST_F(OnDemand, BoardThatRestarts_HasItsPeriodsAgain) {
    demand(R"({"services":{"distance":10},"lease":300})");
    sent(2s);
    bench.say(bench.board.reboot());
    EXPECT_THAT(sent(2s), Contains("D,A,100"));
    bench.unplug();
    bench.plug();
    EXPECT_THAT(sent(2s), Contains("D,A,100"));
}

TEST_F(OnDemand, DemandsWhileTheBoardIsAway_CountOnceItIsBack) {
    sent(2s);
    bench.unplug();
    demand(R"({"services":{"distance":10}})");
    EXPECT_THAT(sent(2s), IsEmpty());
    bench.plug();
    EXPECT_THAT(sent(2s), Contains("D,A,100"));
    bench.unplug();
    bench.pass(1min);
    bench.plug();
    const auto lines = sent(2s);
    ASSERT_THAT(lines, Contains("D,A,0"));
    EXPECT_EQ(lines.back(), "I,A,0");
}

TEST_F(OnDemand, PeriodSetByACommand_HoldsAsADemandWithoutEnd) {
    sent(2s);
    bench.hear("asip/uno1/distance/in", R"({"report":200})");
    EXPECT_THAT(sent(1min), ElementsAre("D,A,200"));
    demand(R"({"services":{"distance":1}})");
    EXPECT_THAT(sent(1s), IsEmpty()) << "it is faster already";
    demand(R"({"services":{"distance":50}})");
    EXPECT_THAT(sent(1s), ElementsAre("D,A,20"));
    bench.hear("asip/uno1/in", "D,A,400");
    EXPECT_THAT(sent(2s), ElementsAre("D,A,400", "D,A,20")) << "somebody demands more";
    EXPECT_THAT(sent(1min), ElementsAre("D,A,400"));
    bench.client_says("D,A,0");
    EXPECT_THAT(sent(1min), ElementsAre("D,A,0"));
}

TEST_F(OnDemand, CommandThatTheBoardRefuses_ChangesNothing) {
    sent(2s);
    bench.board.replies["D,A,7"] = "~D,A,11{BAD_ARGUMENT}";
    bench.hear("asip/uno1/in", "D,A,7");
    EXPECT_THAT(sent(1min), ElementsAre("D,A,7"));
}

TEST_F(OnDemand, RestartByCommand_EndsWhatWasSetByCommand) {
    bench.hear("asip/uno1/in", "D,A,200");
    sent(2s);
    bench.hear("asip/uno1/in", "#,R");
    EXPECT_THAT(sent(5s), Contains("D,A,0"));
}

TEST_F(OnDemand, BoardThatRefusesAPeriod_IsAskedLessAndLessOften_AndOtherPeriodsAtOnce) {
    sent(2s);
    bench.board.replies["D,A,50"] = "~D,A,11{BAD_ARGUMENT}";
    demand(R"({"services":{"distance":20},"lease":300})");
    EXPECT_LE(sent(2min).size(), 8u);
    EXPECT_EQ(
        std::count(bench.notices.begin(), bench.notices.end(), "the board refuses a period for reports"), 1);
    demand(R"({"services":{"distance":10},"lease":300})");
    EXPECT_THAT(sent(2s), ElementsAre("D,A,100"));
}

TEST_F(OnDemand, LineThatIsLost_IsSentAgain) {
    sent(2s);
    bench.board.lose_lines = 2;
    demand(R"({"services":{"distance":10},"lease":300})");
    EXPECT_THAT(sent(20s), Contains("D,A,100"));
}

TEST_F(OnDemand, GarbageAndStoredDemands_ChangeNothing_AndStoredOnesAreCleared) {
    sent(2s);
    demand("rubbish");
    demand(R"({"services":{"distance":NaN}})");
    demand(R"({"services":{"distance":-5}})");
    demand(R"({"services":{"distance":5}})", "ann/c9", true);
    EXPECT_THAT(bench.on("asip/servicebus/uno1/$demand/ann/c9"), ElementsAre("")) << "cleared";
    demand(std::string(100'000, '['));
    demand(R"({"services":{"servo":5,"nosuch":9,"*":0}})");  // is one, of nothing that reports
    bench.hear("asip/servicebus/uno2/$demand/ann/c1", R"({"services":{"*":5}})");
    bench.hear("asip/servicebus/uno1/$demand/ann", R"({"services":{"*":5}})");
    bench.hear("asip/servicebus/uno1/$demand/ann/c/x", R"({"services":{"*":5}})");
    EXPECT_THAT(sent(5s), IsEmpty());
    const auto counted = statistics();
    EXPECT_EQ(counted["rejected"], 4);
    EXPECT_EQ(counted["demanders"], 1);
    EXPECT_EQ(counted["changes"], 2) << "at the start";
}

TEST_F(OnDemand, TenThousandDemanders_AreBounded) {
    sent(2s);
    for (int i = 0; i < 10'000; ++i)
        demand(R"({"services":{"*":1e308}})", "u/" + std::to_string(i));
    EXPECT_THAT(sent(2s), UnorderedElementsAre("D,A,20", "I,A,20"));
    EXPECT_EQ(statistics()["demanders"], Demands::kMax);
    EXPECT_EQ(statistics()["rejected"], 10'000 - Demands::kMax);
}

struct Resting : OnDemand {
    Resting() : OnDemand(on_demand(10s)) {}
};

TEST_F(Resting, WhereNobodyDemands_ValuesComeSlowly) {
    EXPECT_THAT(sent(2s), UnorderedElementsAre("D,A,10000", "I,A,10000"));
    demand(R"({"services":{"distance":10},"lease":5})");
    EXPECT_THAT(sent(20s), ElementsAre("D,A,100", "D,A,10000"));
    bench.hear("asip/uno1/in", "D,A,0");
    EXPECT_THAT(sent(20s), ElementsAre("D,A,0")) << "who sets a period sets it, off too";
}

struct Shared : OnDemand {
    static BridgeOptions options() {
        auto options = on_demand();
        options.reports.shared = true;
        return options;
    }
    Shared() : OnDemand(options()) {}
};

TEST_F(Shared, ServiceThatNobodyDemands_IsLeftAsItIs) {
    EXPECT_THAT(sent(1min), IsEmpty());
    EXPECT_TRUE(described().contains("on_demand")) << "demands are taken";
    bench.hear("asip/uno1/distance/in", R"({"report":200})");
    EXPECT_THAT(sent(1min), ElementsAre("D,A,200"));
    EXPECT_EQ(described()["services"][2]["period"], 200);
}

TEST_F(Shared, Demand_HoldsWhileItLasts_AndAfterItAgainAndAgainThePeriodThatWasSet) {
    bench.hear("asip/uno1/distance/in", R"({"report":200})");
    sent(2s);
    for (int i = 0; i < 3; ++i) {
        demand(R"({"services":{"distance":10},"lease":5})");
        EXPECT_THAT(sent(2s), ElementsAre("D,A,100"));
        EXPECT_EQ(described()["services"][2]["period"], 200) << "not what the demand brings about";
        EXPECT_THAT(sent(20s), ElementsAre("D,A,200"));
    }
    bench.hear("asip/uno1/in", "D,A,0");
    sent(2s);
    demand(R"({"services":{"distance":10},"lease":5})");
    EXPECT_THAT(sent(20s), ElementsAre("D,A,100", "D,A,0"));
}

TEST_F(Shared, OtherServices_AreNotTouchedByADemand) {
    demand(R"({"services":{"distance":10},"lease":5})");
    EXPECT_THAT(sent(1min), ElementsAre("D,A,100", "D,A,0"));
    bench.unplug();
    bench.plug();
    EXPECT_THAT(sent(1min), Not(Contains(testing::StartsWith("I,A")))) << "nobody demanded it";
}

TEST_F(Shared, BoardThatRestarts_HasTheDemandedPeriodAgain) {
    demand(R"({"services":{"distance":10},"lease":300})");
    sent(2s);
    bench.say(bench.board.reboot());
    EXPECT_THAT(sent(2s), Contains("D,A,100"));
}

TEST(Always, AgentWithoutTheOption_LeavesPeriodsAlone) {
    OnlineBench bench;
    bench.hear("asip/servicebus/uno1/$demand/ann/c1", R"({"services":{"*":5}})");
    bench.pass(5s);
    EXPECT_THAT(bench.board.executed, IsEmpty());
    const auto description = nlohmann::json::parse(bench.on("asip/servicebus/uno1/$description").back());
    EXPECT_FALSE(description.contains("on_demand"));
}

}  // namespace
}  // namespace asip::agent
