// SPDX-License-Identifier: Apache-2.0
// How much the values of boards may take, whatever a board publishes.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "clock.hpp"
#include "gateway/stream/value_feed.hpp"
#include "gateway/stream/values.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string long_report(const std::string& event, std::size_t bytes) {
    return "{\"" + event + "\":\"" + std::string(bytes, 'x') + "\"}";
}

TEST(ValueBounds, LongValue_OnlyItsBeginningIsKeptAndItsLengthIsSaid) {
    Values values("e1");
    const auto whole = long_report("a", 60'000);
    values.value("uno1", "s", whole, false, at(0ms));
    EXPECT_EQ(values.find("uno1", "s")->channels[0].json(), whole) << "not longer than may be";
    const auto payload = long_report("a", 200'000);
    ValueFeed feed(values, {.board = "uno1", .service = "s", .after = {}, .after_each = {}, .allowed = {}});
    StreamEvent event;
    while (feed.next(event, at(0ms))) {
    }
    values.value("uno1", "s", payload, false, at(0ms));
    const auto& channel = values.find("uno1", "s")->channels.at(0);
    const auto kept = json::parse(channel.json());
    ASSERT_TRUE(kept.is_string());
    EXPECT_TRUE(payload.starts_with(kept.get<std::string>()));
    EXPECT_GT(channel.json().size(), 30'000u);
    EXPECT_LE(channel.json().size(), ValueLimits{}.value);
    EXPECT_EQ(channel.event, "a") << "of the same event as before";
    ASSERT_TRUE(feed.next(event, at(0ms)));
    EXPECT_THAT(event.data, HasSubstr(",\"cut\":" + std::to_string(payload.size()) + "}"));
    values.value("uno1", "s", R"({"a":1})", false, at(0ms));
    EXPECT_EQ(channel.json(), R"({"a":1})");
    ASSERT_TRUE(feed.next(event, at(0ms)));
    EXPECT_EQ(event.data.find("cut"), std::string::npos) << "the next one is whole";
}

TEST(ValueBounds, WhatGrowsAsJson_IsCutAsWell) {
    Values values("e1");
    values.value("uno1", "s", std::string(60'000, '\x01'), false, at(0ms));
    values.value("uno1", "t", std::string(60'000, '\xff'), false, at(0ms));
    for (const char* service : {"s", "t"}) {
        const auto& channel = values.find("uno1", service)->channels.at(0);
        EXPECT_LE(channel.json().size(), ValueLimits{}.value) << service;
        EXPECT_EQ(channel.cut, 60'000u);
        EXPECT_FALSE(json::parse(channel.json(), nullptr, false).is_discarded());
    }
    std::string umlauts = "x";
    while (umlauts.size() < 100'000)
        umlauts += "\xC3\xA4";
    values.value("uno1", "u", umlauts, false, at(0ms));
    EXPECT_EQ(values.find("uno1", "u")->channels.at(0).json().find("\xEF\xBF\xBD"), std::string::npos)
        << "no character is cut in two";
}

// More services than are kept, each with more long events: what one board's credential may publish.
TEST(ValueBounds, OneBoardsLastValues_HaveABoundInBytesAndLeaveOthersTheirs) {
    Values values("e1", {.value = 4096});
    values.value("other", "s", long_report("a", 4000), false, at(0ms));
    const auto before = values.last_bytes();
    const std::string text(5000, 'x');
    for (int service = 0; service < 260; ++service) {
        const auto name = "s" + std::to_string(service);
        for (int event = 0; event < 18; ++event)
            values.value("evil", name, "{\"e" + std::to_string(event) + "\":\"" + text + "\"}", false,
                         at(0ms));
        values.value("evil", name, text, true, at(0ms));
    }
    EXPECT_LT(values.last_bytes() - before, 6u << 20);
    EXPECT_LE(values.bytes(), ValueLimits{}.bytes);
    values.value("other", "s", long_report("a", 4000), false, at(0ms));
    EXPECT_EQ(values.find("other", "s")->channels[0].cut, 0u) << "another board's are whole";
    values.forget("evil");
    values.forget("other");
    EXPECT_EQ(values.last_bytes(), 0u);
}

TEST(ValueBounds, LastValuesOfManyBoards_HaveABound) {
    Values values("e1", {.points = 2, .value = 1000, .board_last_bytes = 1u << 20, .last_bytes = 1u << 20});
    for (int board = 0; board < 100; ++board)
        for (int service = 0; service < 100; ++service)
            values.value("b" + std::to_string(board), "s" + std::to_string(service), long_report("a", 70'000),
                         false, at(0ms));
    EXPECT_LT(values.last_bytes(), (2u << 20) + 2000);
    EXPECT_GT(values.services(), 100u);
}

TEST(ValueBounds, AHundredThousandValues_TheirOrderOfArrivalIsCountedAndDoesNotGrow) {
    Values values("e1", {.points = 100});
    values.value("uno1", "quiet", R"({"a":1})", false, at(0ms));
    std::size_t most = 0;
    for (int i = 0; i < 100'000; ++i) {
        values.value("uno1", i % 3 == 0 ? "loud" : "louder", "[1]", false, at(0ms));
        most = std::max(most, values.bytes());
    }
    EXPECT_LT(most, 100'000u) << "of 201 values";
    EXPECT_EQ(values.find("uno1", "quiet")->points.size(), 1u) << "which is the oldest of all";
    values.expire(at(1h));
    EXPECT_EQ(values.bytes(), 0u);
    EXPECT_EQ(values.find("uno1", "louder")->points.size(), 0u);
}

TEST(ValueBounds, BoardForgottenAmongOthers_TheOrderOfArrivalStaysRight) {
    Values values("e1", {.points = 10});
    for (int i = 0; i < 5000; ++i) {
        for (const char* board : {"a", "b"})
            values.value(board, "s", std::to_string(i), false, at(std::chrono::milliseconds(i)));
        if (i % 700 == 0) values.forget("a");
    }
    EXPECT_EQ(values.find("b", "s")->points.size(), 10u);
    EXPECT_EQ(values.find("b", "s")->points.back().json, "4999");
    values.expire(at(1h));
    EXPECT_EQ(values.bytes(), 0u);
    values.value("a", "s", "1", false, at(1h));
    EXPECT_EQ(values.find("a", "s")->points.size(), 1u);
}

TEST(ValueBounds, FewPointsOfOnceMany_KeepASmallBlock) {
    Values values("e1");
    for (int i = 0; i < 1200; ++i)
        values.value("uno1", "s", "1", false, at(0ms));
    const auto many = values.bytes();
    values.value("uno1", "s", "2", false, at(9min));
    values.expire(at(11min));
    EXPECT_EQ(values.find("uno1", "s")->points.size(), 1u);
    EXPECT_LT(values.bytes(), many / 100);
}

}  // namespace
}  // namespace asip::gateway
