// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "asip/bus/answer.hpp"
#include "asip/bus/items.hpp"
#include "asip/bus/query.hpp"
#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"
#include "asip/time.hpp"
#include "registry/history/journal.hpp"

struct sqlite3;

namespace asip::registry {

/// Changes of the catalogue with their times of day, in an SQLite file. Bounded by age and by size: the
/// oldest rows are dropped first. A crash loses what write() was not given yet and leaves the file whole.
///
/// Blocks while it reads and writes: HistoryKeeper uses it from a thread of its own.
class History {
  public:
    struct Options {
        std::string path;
        Duration max_age = std::chrono::hours(90 * 24);
        std::size_t max_bytes = 256u << 20;
    };
    /// Rows that one query looks at. A page ends there, with a cursor, however few of them matched.
    static constexpr std::size_t kMaxRowsPerQuery = 20'000;

    /// Opens or makes the file; a file of an earlier version is brought up to date. Throws std::runtime_error
    /// that names the file and what is wrong with it.
    explicit History(Options options);
    ~History();
    History(const History&) = delete;
    History& operator=(const History&) = delete;

    /// In one transaction, in this order. Throws std::runtime_error where the file cannot be written.
    void write(const std::vector<bus::HistoryItem>& items);
    /// Drops what is older than `max_age` at `now`, then the oldest until the file fits. Throws as write().
    void trim(text::WallTime now);

    /// Changes of the boards that `query.board` matches, newest first; `query.state` limits them to changes
    /// into these states. A page may hold fewer than `query.limit` items, or none, and still have a cursor:
    /// then there is more to look at. Error: a sentence on a state or cursor that is none.
    Expected<bus::Answer> find(const bus::Query& query);

    /// Every board that was not forgotten since.
    JournalBoards boards();

  private:
    [[noreturn]] void fail_to_open();
    void execute(const char* sql);
    std::int64_t pragma(const char* sql);
    std::size_t used_bytes();

    Options options_;
    sqlite3* database_ = nullptr;
};

}  // namespace asip::registry
