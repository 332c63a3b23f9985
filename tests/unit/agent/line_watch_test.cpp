// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/line_watch.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

TEST(LineWatch, Bytes_ComeWithDirectionAndAge_AsLongAsSomebodyWatches) {
    LineWatch watch;
    const Time begin = Time{} + 1h;
    watch.received("nobody sees this\n", begin);
    EXPECT_EQ(watch.next_deadline(), std::nullopt);
    watch.watch_until(begin + 15s);
    watch.received("@D,e,2,{4", begin);
    watch.received("2,7}\n", begin + 4ms);
    watch.sent("S,W,0,90\n", begin + 5ms);
    ASSERT_EQ(watch.next_deadline(), begin) << "the first at once";
    EXPECT_EQ(json::parse(watch.take(begin + 100ms)),
              json::parse(R"({"line":[["<",0.1,"@D,e,2,{42,7}\n"],[">",0.095,"S,W,0,90\n"]]})"));
    watch.received(std::string("\0\xff", 2), begin + 120ms);
    EXPECT_EQ(watch.take(begin + 299ms), "") << "five times a second";
    EXPECT_EQ(watch.next_deadline(), begin + 300ms);
    EXPECT_EQ(json::parse(watch.take(begin + 300ms)), json::parse(R"({"line":[["<",0.18,"\u0000ÿ"]]})"));
    watch.received("later", begin + 15s);
    EXPECT_EQ(watch.take(begin + 20s), "");
}

TEST(LineWatch, MoreThanTheBound_IsCountedAndTheNextIsThere) {
    LineWatch watch;
    watch.watch_until(Time{} + 1h);
    for (int i = 0; i < 1000; ++i)
        watch.received(std::string(100, '\x01'), Time{} + 1s);
    auto told = watch.take(Time{} + 1s);
    EXPECT_LT(told.size(), 32u * 1024);
    EXPECT_EQ(json::parse(told)["dropped"], 100'000 - LineWatch::kMaxBytes);
    watch.sent("next", Time{} + 2s);
    EXPECT_EQ(json::parse(watch.take(Time{} + 2s)), json::parse(R"({"line":[[">",0.0,"next"]]})"));
}

TEST(LineWatch, AgentTellsIt_WhileItIsDemanded) {
    OnlineBench bench;
    constexpr const char* kTopic = "asip/uno1/$line/out";
    bench.pass(2s);
    EXPECT_TRUE(bench.on(kTopic).empty());
    bench.hear("asip/servicebus/uno1/$demand/ann/c1", R"({"services":{"*":5},"lease":15})");
    bench.pass(2s);
    EXPECT_TRUE(bench.on(kTopic).empty()) << "all services are not the line";
    bench.hear("asip/servicebus/uno1/$demand/ann/c1", R"({"services":{"$line":5},"lease":15})");
    bench.pass(10s);
    ASSERT_FALSE(bench.on(kTopic).empty());
    EXPECT_THAT(bench.on(kTopic).front(), testing::HasSubstr("[\">\","))
        << "the agent asks whether the board is there";
    bench.pass(30s);
    const auto count = bench.on(kTopic).size();
    bench.pass(10s);
    EXPECT_EQ(bench.on(kTopic).size(), count) << "nobody watches";
}

}  // namespace
}  // namespace asip::agent
