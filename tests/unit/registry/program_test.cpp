// The parts of the program that need no broker: options, history, tidying up.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "asip/text/wall_time.hpp"
#include "registry/history.hpp"
#include "registry/options.hpp"
#include "registry/tidier.hpp"

namespace asip::registry {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

Time at(Duration since_start) {
    return Time{} + 1h + since_start;
}
text::WallTime wall(std::int64_t milliseconds) {
    return text::WallTime(std::chrono::milliseconds(milliseconds));
}

TEST(RegistryOptions, TimesAndSizes) {
    EXPECT_EQ(parse_period("90"), Duration(90s));
    EXPECT_EQ(parse_period("15m"), Duration(15min));
    EXPECT_EQ(parse_period("7d"), Duration(7 * 24h));
    EXPECT_EQ(parse_period("1500ms"), Duration(1500ms));
    EXPECT_EQ(parse_size("512k"), 512u * 1024);
    for (const char* bad : {"", "h", "0s", "500ms", "1w", "-1s", "99999999999999999999d", "40000d"}) {
        EXPECT_FALSE(parse_period(bad)) << bad;
    }
    for (const char* bad : {"", "k", "1", "-1M", "1T", "99999999999999G"})
        EXPECT_FALSE(parse_size(bad)) << bad;
}

class HistoryTest : public testing::Test {
  protected:
    HistoryTest() : path_(testing::TempDir() + "asip-history-" + std::to_string(getpid()) + ".db") {
        clear();
    }
    ~HistoryTest() override { clear(); }
    void clear() {
        for (const char* suffix : {"", "-wal", "-shm"})
            std::remove((path_ + suffix).c_str());
    }
    static Event state_change(const std::string& board) {
        Event event{Event::Kind::kState, board};
        event.state = model::BoardState::Lost;
        event.was = model::BoardState::Online;
        event.reason = Event::Reason::kLease;
        return event;
    }
    static std::vector<std::string> boards(History& history, bus::Query query = {}) {
        std::vector<std::string> names;
        const bus::Answer answer = history.find(query).value();
        for (const auto& item : answer.history)
            names.push_back(item.board);
        return names;
    }
    std::string path_;
};

TEST_F(HistoryTest, KeepsChangesOverARestartNewestFirst) {
    {
        History history({.path = path_});
        history.add({Event::Kind::kAdded, "uno1", 1, model::BoardState::Online}, wall(1000));
        history.add(state_change("uno1"), wall(2000));
        history.add(state_change("uno2"), wall(3000));
    }
    History history({.path = path_});
    EXPECT_THAT(boards(history), ElementsAre("uno2", "uno1", "uno1"));
    bus::Query query;
    query.board = "uno1";
    const auto answer = history.find(query);
    ASSERT_EQ(answer->history.size(), 2u);
    EXPECT_EQ(answer->history[0], (bus::HistoryItem{"uno1", wall(2000), "state", "lost", "online", "lease"}));
    const auto seen = history.seen("uno1");
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->first, wall(1000));
    EXPECT_EQ(seen->last, wall(2000));
    EXPECT_FALSE(history.seen("nobody"));
}

TEST_F(HistoryTest, PagesHoldEachChangeOnce) {
    History history({.path = path_});
    for (int i = 0; i < 25; ++i)
        history.add(state_change("b" + std::to_string(i)), wall(i));
    bus::Query query;
    query.limit = 10;
    std::size_t count = 0;
    for (int pages = 0; pages < 5; ++pages) {
        const auto answer = history.find(query);
        ASSERT_TRUE(answer);
        count += answer->history.size();
        query.cursor = answer->cursor;
        if (query.cursor.empty()) break;
    }
    EXPECT_EQ(count, 25u);
    query.cursor = "x'; DROP TABLE changes";
    EXPECT_FALSE(history.find(query));
    query.cursor.clear();
    query.board = "b1' OR '1'='1";
    EXPECT_THAT(boards(history, query), IsEmpty());
}

TEST_F(HistoryTest, DropsWhatIsTooOld) {
    History history({.path = path_, .max_age = 10s});
    history.add(state_change("old"), wall(1'000));
    history.add(state_change("new"), wall(20'000));
    history.tick(at(0s));
    EXPECT_THAT(boards(history), ElementsAre("new"));
    EXPECT_FALSE(history.seen("old"));
}

TEST_F(HistoryTest, StaysBelowItsSizeByDroppingTheOldest) {
    constexpr std::size_t kMost = 256 * 1024;
    History history({.path = path_, .max_bytes = kMost});
    for (int i = 0; i < 20'000; ++i)
        history.add(state_change("board" + std::to_string(i % 100)), wall(i));
    history.tick(at(0s));
    bus::Query query;
    query.limit = 1;
    const auto newest = history.find(query);
    ASSERT_EQ(newest->history.size(), 1u);
    EXPECT_EQ(newest->history[0].at, wall(19'999));
    for (int turn = 1; turn <= 5; ++turn) {
        for (int i = 0; i < 2'000; ++i)
            history.add(state_change("more"), wall(20'000 + turn));
        history.tick(at(turn * 2min));
    }
    EXPECT_LT(std::filesystem::file_size(path_), 4 * kMost);
}

TEST_F(HistoryTest, FileThatIsNone_IsToldByName) {
    try {
        History history({.path = "/nonexistent/folder/x.db"});
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("/nonexistent/folder/x.db"));
    }
}

class TidierTest : public testing::Test {
  protected:
    bus::Topics topics;
    std::vector<std::string> emptied, subscribed, unsubscribed;
    bool alive = false;
    Tidier tidier{topics,
                  BusPort{[this](mqtt::Message message) {
                              EXPECT_TRUE(message.retain);
                              EXPECT_EQ(message.payload, "");
                              emptied.push_back(message.topic);
                          },
                          [this](std::string filter, bool) { subscribed.push_back(filter); },
                          [this](const std::string& filter) { unsubscribed.push_back(filter); }},
                  [this](const std::string&) { return alive; }};
};

TEST_F(TidierTest, GhostIsEmptiedAfterAMomentUnlessItCameBack) {
    tidier.ghost("uno1", at(0s));
    tidier.tick(at(1s));
    EXPECT_THAT(emptied, IsEmpty());
    tidier.tick(at(2s));
    EXPECT_THAT(emptied, ElementsAre("asip/servicebus/uno1/$description"));
    tidier.ghost("uno2", at(2s));
    alive = true;
    tidier.tick(at(9s));
    EXPECT_EQ(emptied.size(), 1u);
}

TEST_F(TidierTest, ForgottenBoard_IsSweptForWhatElseIsRetained) {
    tidier.forgotten("uno1");
    EXPECT_EQ(emptied.size(), 3u);
    tidier.retained("asip/uno1/in", "uno1");
    EXPECT_EQ(emptied.size(), 3u) << "not asked for yet";
    tidier.tick(at(0s));
    EXPECT_THAT(subscribed, ElementsAre("asip/uno1/#"));
    tidier.retained("asip/uno1/in", "uno1");
    tidier.retained("asip/uno2/in", "uno2");
    EXPECT_EQ(emptied.back(), "asip/uno1/in");
    EXPECT_EQ(emptied.size(), 4u);
    tidier.tick(at(3s));
    EXPECT_THAT(unsubscribed, ElementsAre("asip/uno1/#"));
}

}  // namespace
}  // namespace asip::registry
