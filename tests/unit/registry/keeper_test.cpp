// SPDX-License-Identifier: Apache-2.0
// The history beside a catalogue, with real files that cannot be used for a while. A folder in place of the
// file, and a file that is none, are given to a real registry (tests/integration/registry).
#include "registry/history/keeper.hpp"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>

#include "history_files.hpp"
#include "messages.hpp"

namespace asip::registry {
namespace keeper_test {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// A file in a folder of its own.
class Folder {
  public:
    Folder() { fs::create_directories(path_); }
    ~Folder() { fs::remove_all(path_); }
    std::string file() const { return (path_ / "history.db").string(); }

  private:
    fs::path path_ = testing::TempDir() + "asip-keeper-" + std::to_string(getpid());
};

/// Another program that locks the file.
class Lock {
  public:
    explicit Lock(const std::string& file) {
        EXPECT_EQ(sqlite3_open(file.c_str(), &database_), SQLITE_OK);
        EXPECT_EQ(sqlite3_exec(database_, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
    }
    ~Lock() { sqlite3_close(database_); }

  private:
    sqlite3* database_ = nullptr;
};

/// The page where the table begins.
void spoil_clock(const std::string& file) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    int page = 0;
    const auto read = [](void* to, int, char** row, char**) {
        return *static_cast<int*>(to) = std::stoi(*row), 0;
    };
    sqlite3_exec(database, "SELECT rootpage FROM sqlite_master WHERE name='clock'", read, &page, nullptr);
    ASSERT_GT(page, 0);
    // Behind this change, the keeper reads the page from the file.
    for (const char* sql : {"UPDATE clock SET wall=wall+1", "PRAGMA wal_checkpoint(TRUNCATE)"})
        ASSERT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK)
            << sqlite3_errmsg(database);
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
        .seekp((page - 1) * 4096)
        .write(std::string(4096, 'x').data(), 4096);
    sqlite3_close(database);
}

class Keeping {
  public:
    explicit Keeping(const std::string& file, Duration start = 0s) : now_(start), keeper_(make(file)) {}

    static constexpr std::size_t kMaxWaitingRows = 2'000;

    void added(const std::string& board) {
        keeper_->change({Event::Kind::kAdded, board, 1, model::BoardState::kOnline}, moment());
    }
    void state(const std::string& board, model::BoardState state) {
        keeper_->change({Event::Kind::kState, board, 1, state}, moment());
    }
    void complete() { keeper_->complete(catalogue_, moment()); }
    /// Lets time pass until `condition`; false: a day went by.
    bool until(const std::function<bool()>& condition) {
        for (int step = 0; step < 24 * 3600; ++step) {
            if (condition()) return true;
            now_ += 1s;
            keeper_->tick(catalogue_, moment());
            settle();
        }
        return false;
    }
    void pass(Duration time) {
        for (const Duration end = now_ + time; now_ < end;)
            until([once = true]() mutable { return !std::exchange(once, false); });
    }
    bus::Answer ask() {
        std::optional<bus::Answer> answer;
        bus::Query query;
        query.find = bus::Find::kHistory;
        keeper_->find(query, [&](bus::Answer found) { answer = std::move(found); });
        while (!answer && io_.run_one() > 0) {
        }
        return *answer;
    }
    std::vector<std::string> rows() {
        std::vector<std::string> result;
        for (const auto& item : ask().history)
            result.push_back(item.board + " " + item.what + " " + item.state);
        return result;
    }
    HistoryKeeper& keeper() { return *keeper_; }
    void end() { keeper_.reset(); }

    std::vector<std::string> log;

  private:
    Instant moment() const {
        return {at(now_),
                wall(1'700'000'000'000) + std::chrono::duration_cast<std::chrono::milliseconds>(now_)};
    }
    std::unique_ptr<HistoryKeeper> make(const std::string& file) {
        HistoryKeeper::Handlers handlers;
        handlers.failed = [this](const std::string& why) { log.push_back("failed: " + why); };
        handlers.works_again = [this](std::size_t lost) {
            log.push_back("again, lost " + std::to_string(lost));
        };
        handlers.begun_anew = [this](const std::string& aside, const std::string&) {
            log.push_back("aside " + fs::path(aside).filename().string());
        };
        return std::make_unique<HistoryKeeper>(
            io_, History::Options{.path = file, .max_waiting_rows = kMaxWaitingRows}, handlers, "boot",
            moment());
    }
    // Each question to the other thread is answered behind what it was given before.
    void settle() {
        const bool in_order = keeper_->fault().empty();
        if (in_order) ask();
        io_.run_for(in_order ? 0ms : 2ms);
        io_.restart();
    }

    boost::asio::io_context io_;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    Duration now_;
    Catalogue catalogue_;
    std::unique_ptr<HistoryKeeper> keeper_;
};

TEST(HistoryKeeper, AnotherProgramLocksTheFile_NothingIsLostAndTheOrderStays) {
    Folder folder;
    Keeping run(folder.file());
    run.complete();
    run.added("uno1");
    run.pass(2s);
    {
        const Lock lock(folder.file());
        run.added("uno2");
        ASSERT_TRUE(run.until([&] { return run.log.size() == 1; }));
        run.state("uno2", model::BoardState::kLost);
        EXPECT_THAT(run.log[0], HasSubstr("locked"));
    }
    ASSERT_TRUE(run.until([&] { return run.log.size() == 2; }));
    EXPECT_EQ(run.log[1], "again, lost 0");
    EXPECT_THAT(run.rows(), ElementsAre("uno2 state lost", "uno2 added online", "uno1 added online"));
    run.end();
    Keeping again(folder.file(), 1h);
    EXPECT_EQ(again.keeper().remembered("uno2", {at(1h), wall(0)})->state, model::BoardState::kLost);
}

TEST(HistoryKeeper, FileIsLockedAtTheStart_WhatItKnowsIsNotAddedAgain) {
    Folder folder;
    {
        Keeping run(folder.file());
        run.complete();
        run.added("uno1");
        run.added("uno2");
        run.pass(2s);
    }
    auto lock = std::make_unique<Lock>(folder.file());
    // A lock of this kind keeps no program from reading; a file that must be brought up to date cannot be.
    sqlite3* database = nullptr;
    lock.reset();
    ASSERT_EQ(sqlite3_open(folder.file().c_str(), &database), SQLITE_OK);
    ASSERT_EQ(
        sqlite3_exec(database, "PRAGMA journal_mode=DELETE; BEGIN EXCLUSIVE", nullptr, nullptr, nullptr),
        SQLITE_OK);
    Keeping run(folder.file(), 1h);
    ASSERT_EQ(run.log.size(), 1u);
    run.complete();
    run.added("uno1");
    run.state("uno1", model::BoardState::kLost);
    run.added("uno2");
    run.added("uno3");
    sqlite3_close(database);
    ASSERT_TRUE(run.until([&] { return run.log.size() == 2; }));
    EXPECT_THAT(run.rows(), ElementsAre("uno3 added online", "uno1 state lost", "uno2 added online",
                                        "uno1 added online"));
    EXPECT_EQ(run.keeper().remembered("uno1", {at(2h), wall(0)})->first_seen, wall(1'700'000'000'000));
}

TEST(HistoryKeeper, FileIsDamagedWhileItIsUsed_BoardsAreKnownInTheNewOne) {
    Folder folder;
    {
        Keeping run(folder.file());
        run.complete();
        for (int i = 0; i < 2000; ++i)
            run.added("uno" + std::to_string(i));
        run.pass(2s);
    }
    {
        std::fstream file(folder.file(), std::ios::in | std::ios::out | std::ios::binary);
        for (std::size_t page = 4096 * 8; page < fs::file_size(folder.file()); page += 4096)
            file.seekp(static_cast<std::streamoff>(page)).write(std::string(4096, 'x').data(), 4096);
    }
    Keeping run(folder.file(), 1h);
    run.complete();
    run.added("late");
    run.pass(10s);
    ASSERT_THAT(run.log, ElementsAre("aside history.db.damaged"));
    EXPECT_THAT(run.rows(), testing::Contains("late added online"));
}

// In a table that no question reads.
TEST(HistoryKeeper, DamageThatTheWriterAloneFinds_QuestionsReadTheNewFile) {
    Folder folder;
    Keeping run(folder.file());
    run.complete();
    run.added("uno1");
    EXPECT_THAT(run.rows(), ElementsAre("uno1 added online"));
    spoil_clock(folder.file());
    run.added("uno2");
    ASSERT_TRUE(run.until([&] { return !run.log.empty(); }));
    EXPECT_THAT(run.log, ElementsAre("aside history.db.damaged"));
    EXPECT_THAT(run.rows(), ElementsAre("uno2 added online"));
}

TEST(HistoryKeeper, FileIsTakenAway_ANewOneKnowsTheBoards) {
    Folder folder;
    Keeping run(folder.file());
    run.complete();
    run.added("uno1");
    run.pass(2s);
    for (const char* part : {"", "-wal", "-shm"})
        fs::remove(folder.file() + part);
    run.added("uno2");
    ASSERT_TRUE(run.until([&] { return run.log.size() == 2; }));
    EXPECT_THAT(run.rows(), ElementsAre("uno2 added online"));
    run.end();
    Keeping again(folder.file(), 1h);
    EXPECT_EQ(again.keeper().remembered("uno1", {at(1h), wall(0)})->state, model::BoardState::kOnline);
}

TEST(HistoryKeeper, TooManyDamagedFilesLieThere_TheReasonSaysSo) {
    Folder folder;
    for (int i = 1; i <= 9; ++i)
        std::ofstream(folder.file() + (i == 1 ? ".damaged" : ".damaged-" + std::to_string(i))) << i;
    std::ofstream(folder.file()) << std::string(10'000, 'x');
    Keeping run(folder.file());
    ASSERT_EQ(run.log.size(), 1u);
    EXPECT_THAT(run.log[0], HasSubstr("cannot be put aside"));
    EXPECT_EQ(run.ask().refused, "history-fault");
}

TEST(HistoryKeeper, FaultLastsLongerThanThereIsRoom_WhatIsLostIsCountedAndBoardsAreKnown) {
    Folder folder;
    fs::create_directories(folder.file());
    Keeping run(folder.file());
    run.complete();
    for (std::size_t i = 0; i < Keeping::kMaxWaitingRows + 10; ++i)
        run.added("b" + std::to_string(i));
    EXPECT_EQ(run.keeper().dropped_rows(), 10u);
    fs::remove(folder.file());
    ASSERT_TRUE(run.until([&] { return run.log.size() == 2; }));
    EXPECT_EQ(run.log[1], "again, lost 10");
    run.end();
    Keeping again(folder.file(), 1h);
    EXPECT_TRUE(again.keeper().remembered("b2009", {at(1h), wall(0)}));
}

}  // namespace keeper_test
}  // namespace asip::registry
