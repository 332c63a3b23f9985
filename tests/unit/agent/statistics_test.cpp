// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;

struct AgentStatistics : testing::Test {
    AgentStatistics() {
        bench.go_online();
        bench.published.clear();
    }
    json document() {
        bench.publish_statistics();
        const auto documents = bench.on("asip/servicebus/uno1/$stats");
        return documents.empty() ? json() : json::parse(documents.back());
    }
    BridgeBench bench;
};

TEST_F(AgentStatistics, Document_NamesItsAgentAndItsStart) {
    const auto first = document();
    EXPECT_EQ(first["board"], "uno1");
    EXPECT_EQ(first["number"], 1);
    EXPECT_DOUBLE_EQ(first["uptime"], 1.5) << "since the port was opened";
    bench.pass(10s);
    const auto second = document();
    EXPECT_EQ(second["session"], first["session"]);
    EXPECT_EQ(second["number"], 2);
    EXPECT_DOUBLE_EQ(second["interval"], 10.0);
}

TEST_F(AgentStatistics, Document_IsNotRetained) {
    bench.publish_statistics();
    EXPECT_FALSE(bench.published.back().message.retain);
}

TEST_F(AgentStatistics, WithoutABus_NothingIsPublished) {
    bench.bridge.bus_disconnected();
    EXPECT_TRUE(document().is_null());
}

TEST_F(AgentStatistics, Line_IsCountedInBytesAndLinesEachWay) {
    const auto before = document()["line"];
    bench.hear("asip/uno1/in", "I,d,13,1");
    bench.say("@D,e,1,{42}\r\n");
    const auto after = document()["line"];
    EXPECT_EQ(after["lines_out"].get<int>() - before["lines_out"].get<int>(), 1);
    EXPECT_EQ(after["bytes_out"].get<int>() - before["bytes_out"].get<int>(), 9);
    EXPECT_EQ(after["lines_in"].get<int>() - before["lines_in"].get<int>(), 1);
    EXPECT_EQ(after["bytes_in"].get<int>() - before["bytes_in"].get<int>(), 13);
    EXPECT_EQ(after["opened"], 1);
}

TEST_F(AgentStatistics, BoardUnplugged_ItsCountersGoOn) {
    bench.unplug();
    bench.plug();
    bench.pass(3s);
    const auto line = document()["line"];
    EXPECT_EQ(line["opened"], 2);
    EXPECT_GT(line["bytes_in"], 100) << "those of both connections";
}

TEST_F(AgentStatistics, DamagedLines_AreCounted) {
    bench.say("@D,e,1,{\x01\x02\r\nnonsense\r\n");
    EXPECT_GE(document()["line"]["malformed"], 1);
}

TEST_F(AgentStatistics, ErrorsOfTheBoard_AreCountedByCode) {
    bench.say("~S,W,7{INVALID_DEVICE_NUMBER}\r\n~S,W,7{INVALID_DEVICE_NUMBER}\r\n~I,d,3{INVALID_PIN}\r\n");
    EXPECT_EQ(document()["errors"], json::parse(R"({"3":1,"7":2})"));
}

TEST_F(AgentStatistics, ErrorsWithEveryCodeThereIs_TakeNoMoreRoom) {
    std::string lines;
    for (int code = 100; code < 1000; ++code)
        lines += "~S,W," + std::to_string(code) + "{X}\r\n";
    bench.say(lines);
    const auto errors = document()["errors"];
    EXPECT_LE(errors.size(), 33u);
    EXPECT_EQ(errors["other"], 900 - 32);
}

TEST_F(AgentStatistics, Commands_AreCountedByOutcome) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "1");
    bench.ask("asip/uno1/servo/in", {{"write", {9, 90}}}, "2");
    bench.ask("asip/uno1/servo/in", {{"write", {9, 900}}}, "3");
    bench.hear("asip/uno1/servo/in", "W,0,90");
    bench.pass(200ms);
    EXPECT_EQ(document()["commands"], json::parse(R"({"error":1,"ok":1,"refused/invalid":1,"unproven":1})"));
    bench.unplug();
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "4");
    EXPECT_EQ(document()["commands"]["refused/board-not-there"], 1);
}

TEST_F(AgentStatistics, RoundTrips_AreAHistogramAndQuantilesOfTheLastInterval) {
    for (int i = 0; i < 10; ++i)
        bench.ask("asip/uno1/servo/in", {{"write", {0, i}}}, std::to_string(i));
    const auto trips = document()["round_trip"];
    EXPECT_EQ(trips["count"], 10);
    ASSERT_EQ(trips["le"].size(), trips["buckets"].size());
    EXPECT_EQ(trips["buckets"].back(), 10) << "cumulative, as Prometheus has them";
    EXPECT_FALSE(trips["p50"].is_null());
    const auto later = document()["round_trip"];
    EXPECT_TRUE(later["p50"].is_null()) << "nothing since the document before";
    EXPECT_EQ(later["count"], 10);
}

TEST(RoundTrips, Quantiles_LieWithinTheirBucket) {
    Histogram histogram;
    EXPECT_FALSE(histogram.quantile(.5));
    for (int i = 0; i < 99; ++i)
        histogram.add(4ms);
    histogram.add(700ms);
    histogram.add(1h);
    EXPECT_GT(*histogram.quantile(.5), .003);
    EXPECT_LE(*histogram.quantile(.5), .005);
    EXPECT_GT(*histogram.quantile(.985), .5);
    EXPECT_LE(*histogram.quantile(.985), 1);
    EXPECT_EQ(*histogram.quantile(1), 60) << "beyond the last bound";
    EXPECT_EQ(histogram.count(), 101u);
}

}  // namespace
}  // namespace asip::agent
