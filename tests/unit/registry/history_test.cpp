// SPDX-License-Identifier: Apache-2.0
#include "registry/history/history.hpp"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <filesystem>

#include "history_files.hpp"

namespace asip::registry {
namespace history_test {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

bus::HistoryItem row(const std::string& board, std::int64_t at, const std::string& state = "lost") {
    return {board, wall(at), "state", state, "online", "lease"};
}

bus::Query boards_like(const std::string& pattern) {
    bus::Query query;
    query.find = bus::Find::kHistory;
    query.board = pattern;
    return query;
}

std::vector<std::string> found(History& history, const bus::Query& query = {}) {
    std::vector<std::string> boards;
    const auto answer = history.find(query).value();
    for (const auto& item : answer.history)
        boards.push_back(item.board);
    return boards;
}

TEST(History, FileReopened_RowsAreThereNewestFirst) {
    const HistoryFile file;
    {
        History history({.path = file.path()});
        history.write({{"uno1", wall(1000), "added", "online", "", "announced"}, row("uno1", 2000)}, {});
        history.write({row("uno2", 3000)}, {});
    }
    History history({.path = file.path()});
    EXPECT_THAT(found(history), ElementsAre("uno2", "uno1", "uno1"));
    const auto answer = history.find(boards_like("uno1"));
    EXPECT_EQ(answer->history.at(0), row("uno1", 2000));
}

TEST(History, Boards_HaveTheTimeOfTheirFirstRowAndOfTheirState) {
    const HistoryFile file;
    {
        History history({.path = file.path()});
        history.write({{"uno1", wall(1000), "added", "online", "", ""}, row("uno1", 2000)}, {});
        history.write({{"uno1", wall(3000), "description", "lost", "", ""}}, {});
        history.write(
            {{"uno2", wall(1000), "added", "online", "", ""}, {"uno2", wall(1500), "forgotten", "", "", ""}},
            {});
    }
    History history({.path = file.path()});
    EXPECT_THAT(
        history.boards(),
        ElementsAre(std::pair("uno1", JournalBoard{wall(1000), wall(2000), model::BoardState::kLost})));
    history.write({{"uno2", wall(9000), "added", "online", "", ""}}, {});
    EXPECT_EQ(history.boards().at("uno2").first, wall(9000)) << "a forgotten board begins anew";
}

/// As former versions had it.
const std::string kChanges =
    "CREATE TABLE changes(id INTEGER PRIMARY KEY, at INTEGER NOT NULL, board TEXT NOT NULL, what TEXT NOT "
    "NULL, state TEXT NOT NULL, was TEXT NOT NULL, reason TEXT NOT NULL);";

/// A file as a former version left it.
void make(const HistoryFile& file, const std::string& statements) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file.path().c_str(), &database), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
}

TEST(History, FileOfTheFirstVersion_ItsBoardsHaveTheStateOfTheirLastRow) {
    const HistoryFile file;
    make(file, std::string("CREATE TABLE boards(name TEXT PRIMARY KEY, first INTEGER NOT NULL, last INTEGER "
                           "NOT NULL) WITHOUT ROWID;") +
                   kChanges +
                   "INSERT INTO boards VALUES('uno1',1000,2000);"
                   "INSERT INTO changes VALUES(1,1000,'uno1','added','online','','');"
                   "INSERT INTO changes VALUES(2,2000,'uno1','state','lost','online','lease')");
    History history({.path = file.path()});
    EXPECT_THAT(
        history.boards(),
        ElementsAre(std::pair("uno1", JournalBoard{wall(1000), wall(2000), model::BoardState::kLost})));
    EXPECT_THAT(found(history), ElementsAre("uno1", "uno1"));
}

bus::HistoryItem command(const std::string& board, std::int64_t at) {
    bus::HistoryItem item{board, wall(at), "command", "", "", "queue-full"};
    item.by = "anna";
    item.service = "servo";
    item.request = R"({"write":[0,90]})";
    item.status = "refused";
    item.count = 3;
    return item;
}

TEST(History, Commands_AreKeptAndChangeNothingOfTheirBoard) {
    const HistoryFile file;
    {
        History history({.path = file.path()});
        history.write({{"uno1", wall(1000), "added", "online", "", ""}, command("uno1", 2000)}, {});
    }
    History history({.path = file.path()});
    const auto answer = history.find(boards_like("uno1"));
    ASSERT_EQ(answer->history.size(), 2u);
    EXPECT_EQ(answer->history[0], command("uno1", 2000));
    EXPECT_FALSE(answer->history[1].is_command());
    EXPECT_THAT(
        history.boards(),
        ElementsAre(std::pair("uno1", JournalBoard{wall(1000), wall(1000), model::BoardState::kOnline})));
    auto states = boards_like("uno1");
    states.state = {"online"};
    EXPECT_THAT(found(history, states), ElementsAre("uno1")) << "a command is no change of state";
}

TEST(History, FileOfTheSecondVersion_TakesCommands) {
    const HistoryFile file;
    make(file, std::string(
                   "CREATE TABLE boards(name TEXT PRIMARY KEY, first INTEGER NOT NULL, last INTEGER NOT "
                   "NULL, state TEXT NOT NULL DEFAULT '', since INTEGER NOT NULL DEFAULT 0) WITHOUT ROWID;") +
                   kChanges +
                   "INSERT INTO boards VALUES('uno1',1000,1000,'online',1000);"
                   "INSERT INTO changes VALUES(1,1000,'uno1','added','online','','');"
                   "PRAGMA user_version=1");
    for (int opened = 0; opened < 2; ++opened) {
        History history({.path = file.path()});
        history.write({command("uno1", 2000 + opened)}, {});
        EXPECT_EQ(found(history).size(), 2u + static_cast<std::size_t>(opened));
    }
}

TEST(History, FileOfALaterVersion_IsAFaultAndStaysAsItIs) {
    const HistoryFile file;
    make(file, "PRAGMA user_version=4");
    try {
        History history({.path = file.path()});
        FAIL();
    } catch (const HistoryFault& fault) {
        EXPECT_THAT(fault.what(), HasSubstr("later version"));
        EXPECT_FALSE(fault.damaged);
    }
}

TEST(History, Pages_HoldEachRowOnce) {
    const HistoryFile file;
    History history({.path = file.path()});
    for (int i = 0; i < 25; ++i)
        history.write({row("b" + std::to_string(i % 7), i)}, {});
    for (const char* pattern : {"", "b*", "b?"}) {
        bus::Query query = boards_like(pattern);
        query.limit = 10;
        std::vector<text::WallTime> times;
        for (int pages = 0; pages < 5; ++pages) {
            const auto answer = history.find(query);
            ASSERT_TRUE(answer);
            for (const auto& item : answer->history)
                times.push_back(item.at);
            query.cursor = answer->cursor;
            if (query.cursor.empty()) break;
        }
        ASSERT_EQ(times.size(), 25u) << pattern;
        for (int i = 0; i < 25; ++i)
            EXPECT_EQ(times[static_cast<std::size_t>(i)], wall(24 - i)) << pattern;
    }
}

TEST(History, CursorBeyondTheNewestRow_IsNoneOfOurs) {
    const HistoryFile file;
    History history({.path = file.path()});
    bus::Query query;
    query.cursor = "7";
    EXPECT_THAT(history.find(query)->history, IsEmpty()) << "all that was there has been dropped";
    history.write({row("b1", 1), row("b1", 2)}, {});
    query.limit = 1;
    const auto answer = history.find(query);
    ASSERT_FALSE(answer);
    EXPECT_THAT(answer.error(), HasSubstr("not one of this registry's"));
    query.cursor = "";
    query.cursor = history.find(query)->cursor;
    EXPECT_THAT(history.find(query)->history, SizeIs(1)) << "the next page";
}

TEST(History, HostileTexts_AreTextsAndNoCommands) {
    const HistoryFile file;
    History history({.path = file.path()});
    history.write({row("b1", 1)}, {});
    bus::Query query;
    query.cursor = "x'; DROP TABLE changes";
    EXPECT_FALSE(history.find(query));
    EXPECT_THAT(found(history, boards_like("b1' OR '1'='1")), IsEmpty());
    EXPECT_THAT(found(history, boards_like("b1")), ElementsAre("b1"));
}

TEST(History, QueryThatMatchesNothing_EndsAPageAfterABoundedNumberOfRows) {
    const HistoryFile file;
    History history({.path = file.path()});
    const std::size_t rows = History::kMaxRowsPerQuery + 5'000;
    history.write(std::vector<bus::HistoryItem>(rows, row("uno1", 1)), {});
    bus::Query query = boards_like("uno1");
    query.state = {"updating"};
    const auto first = history.find(query);
    ASSERT_TRUE(first);
    EXPECT_THAT(first->history, IsEmpty());
    EXPECT_NE(first->cursor, "") << "there is more to look at";
    query.cursor = first->cursor;
    EXPECT_EQ(history.find(query)->cursor, "") << "the rest fits one page";
}

TEST(History, PatternThatNoBoardHas_IsAnsweredFromTheNames) {
    const HistoryFile file;
    History history({.path = file.path()});
    history.write(std::vector<bus::HistoryItem>(History::kMaxRowsPerQuery + 1, row("uno1", 1)), {});
    const auto answer = history.find(boards_like("*nobody*"));
    EXPECT_THAT(answer->history, IsEmpty());
    EXPECT_EQ(answer->cursor, "") << "no row was looked at";
}

TEST(History, StateThatIsNone_IsRefusedWithTheStatesThereAre) {
    const HistoryFile file;
    History history({.path = file.path()});
    bus::Query query;
    query.state = {"onlin"};
    const auto answer = history.find(query);
    ASSERT_FALSE(answer);
    EXPECT_THAT(answer.error(), HasSubstr("\"onlin\" is none of online, offline"));
}

TEST(History, TooOldByTheTimeOfTheFile_IsDroppedButAnOldBoardThatLivesIsKnown) {
    const HistoryFile file;
    History history({.path = file.path(), .max_age = 10s});
    // The clock was a year ahead, and then a year behind.
    history.write({row("gone", 31'536'000'000), row("alive", 31'536'000'000, "online")}, {.kept = 1s});
    history.write({row("new", -31'536'000'000)}, {.kept = 20s});
    history.trim(20s);
    EXPECT_THAT(found(history), ElementsAre("new"));
    const auto boards = history.boards();
    EXPECT_EQ(boards.count("gone"), 0u);
    EXPECT_EQ(boards.count("alive"), 1u);
}

TEST(History, TooLarge_TheOldestRowsAreDropped) {
    constexpr std::size_t kMaxBytes = 256 * 1024;
    const HistoryFile file;
    History history({.path = file.path(), .max_bytes = kMaxBytes});
    std::vector<bus::HistoryItem> rows;
    for (int i = 0; i < 20'000; ++i)
        rows.push_back(row("board" + std::to_string(i % 100), i));
    history.write(rows, {});
    history.trim(20s);
    bus::Query newest;
    newest.limit = 1;
    const auto answer = history.find(newest);
    EXPECT_EQ(answer->history.at(0).at, wall(19'999));
    for (int turn = 1; turn <= 5; ++turn) {
        history.write(std::vector<bus::HistoryItem>(2'000, row("more", 20'000 + turn)), {});
        history.trim(20s);
    }
    EXPECT_LT(std::filesystem::file_size(file.path()), 4 * kMaxBytes);
}

TEST(History, FileThatCannotBe_IsAFaultThatMayPass) {
    try {
        History history({.path = "/nonexistent/folder/x.db"});
        FAIL();
    } catch (const HistoryFault& fault) {
        EXPECT_THAT(fault.what(), HasSubstr("unable to open"));
        EXPECT_FALSE(fault.damaged);
    }
}

}  // namespace history_test
}  // namespace asip::registry
