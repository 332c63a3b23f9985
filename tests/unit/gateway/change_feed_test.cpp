// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/change_log.hpp"

#include <gmock/gmock.h>

#include <map>

#include "clock.hpp"

namespace asip::gateway {
namespace {

using testing::ElementsAre;

/// A catalogue that is a map of names to states, read two boards a page.
class ChangeFeedTest : public testing::Test {
  protected:
    void set(const std::string& board, const std::string& state, ChangeLog* log = nullptr) {
        boards_[board] = state;
        (log != nullptr ? *log : log_)
            .add("state", board, R"({"board":")" + board + R"(","is":")" + state + "\"}");
    }
    ChangeFeed::ReadPage reader(const ChangeFeed::Allowed& allowed = {}) {
        return [this, allowed](const std::string&, const std::string& after, const Instant&) {
            ChangeFeed::Page page;
            auto each = boards_.upper_bound(after);
            for (int looked = 0; each != boards_.end() && looked < 2; ++each, ++looked) {
                page.behind = each->first;
                if (allowed && !allowed(each->first)) continue;
                page.boards.push_back("\"" + each->first + "=" + each->second + "\"");
            }
            page.last = each == boards_.end();
            ++pages_read_;
            return page;
        };
    }
    static std::string shown(const StreamEvent& event) {
        return std::string(event.kind) + " " + (event.place.empty() ? "-" : event.place) + " " + event.data;
    }
    static std::vector<std::string> read(Feed& feed, std::chrono::milliseconds time = 0ms) {
        std::vector<std::string> all;
        do {
            for (StreamEvent event; feed.next(event, at(time));)
                all.push_back(shown(event));
        } while (feed.more());
        return all;
    }

    std::map<std::string, std::string> boards_;
    ChangeLog log_{"e1", 4096};
    int pages_read_ = 0;
};

TEST_F(ChangeFeedTest, Begin_EachBoardThenSnapshotEndThenChanges) {
    set("a", "online");
    set("b", "lost");
    set("c", "online");
    ChangeFeed feed(log_, reader(), {});
    EXPECT_THAT(read(feed), ElementsAre(R"(board - {"board":"a=online"})", R"(board - {"board":"b=lost"})",
                                        R"(board - {"board":"c=online"})", "snapshot-end e1-3 {}"));
    set("b", "online");
    EXPECT_THAT(read(feed), ElementsAre(R"(state e1-4 {"board":"b","is":"online"})"));
}

// Something changes behind each event of the snapshot in turn, to a board already sent and to one not yet
// sent: the reader ends with what is true and sees no change twice.
TEST_F(ChangeFeedTest, ChangesWhileTheSnapshotIsRead_AreInItOrFollowIt) {
    for (std::size_t moment = 0; moment <= 7; ++moment) {
        boards_ = {{"a", "0"}, {"b", "0"}, {"c", "0"}, {"d", "0"}, {"e", "0"}};
        ChangeLog log("e1");
        ChangeFeed feed(log, reader(), {});
        std::vector<std::string> all;
        for (StreamEvent event; true;) {
            if (all.size() == moment && log.last() == 0) set("b", "1", &log), set("d", "1", &log);
            if (feed.next(event, at(0ms)))
                all.push_back(shown(event));
            else if (!feed.more())
                break;
        }
        const auto times = [&](const std::string& text) {
            return std::count_if(all.begin(), all.end(), [&](const std::string& each) {
                return each.find(text) != std::string::npos;
            });
        };
        if (moment > 6) continue;
        for (const std::string board : {"b", "d"}) {
            const auto in_snapshot = times("\"" + board + "=1\"");
            const auto after_it = times(R"("board":")" + board + R"(","is":"1")");
            EXPECT_EQ(in_snapshot + after_it, 1) << board << " changed behind event " << moment;
        }
    }
}

TEST_F(ChangeFeedTest, CutAtEveryEvent_ResumesWithoutGapOrDuplicate) {
    for (int cut = 0; cut <= 20; ++cut) {
        ChangeLog log("e1");
        boards_ = {{"a", "0"}};
        ChangeFeed first(log, reader(), {});
        std::vector<std::string> seen;
        std::optional<Place> last;
        const auto take = [&](Feed& feed, int limit) {
            StreamEvent event;
            while (limit > 0 && (feed.next(event, at(0ms)) || (feed.more() && feed.next(event, at(0ms))))) {
                --limit;
                if (auto place = parse_place(event.place)) last = place;
                if (event.kind == "state") seen.push_back(event.data);
            }
        };
        take(first, 2);
        std::vector<std::string> whole;
        for (int i = 0; i < 20; ++i) {
            set("a", std::to_string(i), &log);
            whole.push_back(R"({"board":"a","is":")" + std::to_string(i) + "\"}");
        }
        take(first, cut);
        ChangeFeed second(log, reader(), {.board = "*", .after = last, .snapshot = true, .allowed = {}});
        take(second, 1000);
        EXPECT_EQ(seen, whole) << "cut behind " << cut;
    }
}

TEST_F(ChangeFeedTest, PlaceOfAnotherRun_ResetAndSnapshot) {
    set("a", "online");
    ChangeFeed feed(log_, reader(), {.board = "*", .after = Place{"e0", 1}, .snapshot = true, .allowed = {}});
    EXPECT_THAT(read(feed), ElementsAre(R"(reset - {"reason":"another-epoch"})",
                                        R"(board - {"board":"a=online"})", "snapshot-end e1-1 {}"));
}

TEST_F(ChangeFeedTest, PlaceOfTheFuture_Reset) {
    ChangeFeed feed(log_, reader(), {.board = "*", .after = Place{"e1", 9}, .snapshot = true, .allowed = {}});
    EXPECT_EQ(read(feed).front(), R"(reset - {"reason":"past-gone"})");
}

TEST_F(ChangeFeedTest, ReaderTooSlowForTheLog_ResetAndSnapshot) {
    boards_ = {{"a", "0"}};
    ChangeFeed feed(log_, reader(), {});
    read(feed);
    for (int i = 0; i < 1000; ++i)
        set("a", std::to_string(i));
    EXPECT_THAT(read(feed), ElementsAre(R"(reset - {"reason":"too-slow"})", R"(board - {"board":"a=999"})",
                                        "snapshot-end e1-1000 {}"));
}

TEST_F(ChangeFeedTest, FilteredAndQuiet_BookmarksMoveThePlaceOn) {
    ChangeFeed feed(log_, reader(),
                    {.board = "z*", .after = Place{"e1", 0}, .snapshot = true, .allowed = {}});
    for (int i = 0; i < 5; ++i)
        set("a", std::to_string(i));
    EXPECT_THAT(read(feed, 0ms), ElementsAre());
    feed.tick(at(14s));
    EXPECT_THAT(read(feed, 14s), ElementsAre());
    feed.tick(at(15s));
    EXPECT_THAT(read(feed, 15s), ElementsAre("bookmark e1-5 {}"));
    feed.tick(at(40s));
    EXPECT_THAT(read(feed, 40s), ElementsAre()) << "nothing happened since";
}

TEST_F(ChangeFeedTest, NotAllowedBoards_AreAsIfTheyWereNotThere) {
    boards_ = {{"a", "0"}, {"b", "0"}};
    const auto allowed = [](std::string_view b) { return b == "b"; };
    ChangeFeed feed(log_, reader(allowed), {.board = "*", .after = {}, .snapshot = true, .allowed = allowed});
    EXPECT_THAT(read(feed), ElementsAre(R"(board - {"board":"b=0"})", "snapshot-end e1-0 {}"));
    set("a", "1");
    EXPECT_THAT(read(feed), ElementsAre());
}

TEST_F(ChangeFeedTest, SnapshotOfHiddenBoards_IsOnePageATurn) {
    for (int i = 0; i < 20; ++i)
        boards_["b" + std::to_string(10 + i)] = "0";
    const auto allowed = [](std::string_view b) { return b == "b29"; };
    ChangeFeed feed(log_, reader(allowed), {.board = "*", .after = {}, .snapshot = true, .allowed = allowed});
    StreamEvent event;
    for (int turn = 1; turn < 10; ++turn) {
        EXPECT_FALSE(feed.next(event, at(0ms))) << turn;
        EXPECT_TRUE(feed.more()) << "it would wait for ever";
        EXPECT_EQ(pages_read_, turn);
    }
    ASSERT_TRUE(feed.next(event, at(0ms)));
    EXPECT_EQ(event.data, R"({"board":"b29=0"})");
    ASSERT_TRUE(feed.next(event, at(0ms)));
    EXPECT_EQ(event.kind, "snapshot-end");
    EXPECT_FALSE(feed.more());
}

TEST_F(ChangeFeedTest, PageThatIsTooMuchForItsReader_EndsTheFeedWithASentence) {
    Budget budget(2000);
    boards_ = {{"a", std::string(3000, 'x')}};
    ChangeFeed feed(log_, reader(),
                    {.board = "*", .after = {}, .snapshot = true, .allowed = {}, .part = budget.part("eve")});
    StreamEvent event;
    EXPECT_FALSE(feed.next(event, at(0ms)));
    EXPECT_EQ(feed.fault(), kTooMuchKept);
    EXPECT_FALSE(feed.more());
    EXPECT_FALSE(feed.next(event, at(0ms)));
}

}  // namespace
}  // namespace asip::gateway
