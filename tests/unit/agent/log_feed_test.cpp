// SPDX-License-Identifier: Apache-2.0
#include "agent/counts/log_feed.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace asip::agent {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using program::log::Field;
using program::log::Level;

constexpr const char* kNow = "2026-11-21T19:00:00.000Z";

void add(LogFeed& feed, const std::string& text, Time now = Time{}) {
    feed.add(Level::kInfo, text, {}, kNow, now);
}

TEST(LogFeed, Line_CarriesTimeLevelTextAndFields) {
    LogFeed feed;
    const std::vector<Field> fields{{"why", "cable"}, {"count", 3}};
    feed.add(Level::kWarning, "board lost", fields, kNow, Time{});
    const auto lines = feed.take();
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(json::parse(lines[0]),
              json::parse(R"({"time":"2026-11-21T19:00:00.000Z","level":"warning","text":"board lost",
                              "why":"cable","count":"3"})"));
    EXPECT_TRUE(feed.take().empty());
}

TEST(LogFeed, Flood_IsBoundedAndSaysWhatIsMissing) {
    LogFeed feed;
    std::size_t published = 0;
    for (int i = 0; i < 10'000; ++i) {
        add(feed, "again", Time{} + i * 1ms);
        published += feed.take().size();
    }
    EXPECT_LE(published, LogFeed::kBurst + 10 * LogFeed::kPerSecond + 1);
    add(feed, "later", Time{} + 60s);
    const auto lines = feed.take();
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_GT(json::parse(lines[0])["dropped"], 0);
}

TEST(LogFeed, NobodyTakesThem_TheNewestAreKept) {
    LogFeed feed;
    for (int i = 0; i < 40; ++i)
        add(feed, std::to_string(i));
    const auto lines = feed.take();
    ASSERT_EQ(lines.size(), LogFeed::kMaxKept);
    EXPECT_EQ(json::parse(lines.back())["text"], "39");
}

TEST(LogFeed, LongAndBrokenText_IsCutAndStaysJson) {
    LogFeed feed;
    add(feed, std::string(100'000, 'x') + "\xff");
    add(feed, "\xff\xfe");
    for (const auto& line : feed.take()) {
        EXPECT_LT(line.size(), 2 * LogFeed::kMaxTextBytes);
        EXPECT_FALSE(json::parse(line, nullptr, false).is_discarded());
    }
}

}  // namespace
}  // namespace asip::agent
