// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/expected.hpp"
#include "asip/time.hpp"
#include "registry/history/journal.hpp"
#include "registry/history/kept_time.hpp"
#include "registry/history/statement.hpp"

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
        std::size_t max_waiting_rows = 200'000;  // how far writing may fall behind (HistoryKeeper)
        bool own_thread = true;                  // false: HistoryKeeper uses the file in its caller's
    };
    /// Rows that one query looks at. A page ends there, with a cursor, however few of them matched.
    static constexpr std::size_t kMaxRowsPerQuery = 20'000;

    /// Opens or makes the file; a file of an earlier version is brought up to date. This and every function
    /// throw HistoryFault where the file cannot be used.
    explicit History(Options options);

    /// In one transaction, in this order, as of the time of the mark. Fails where another file has taken the
    /// place of this one, too.
    void write(const std::vector<bus::HistoryItem>& items, const KeptTime::Mark& mark);
    /// Drops what is older than `max_age` at `now`, then the oldest until the file fits.
    void trim(KeptTime::Milliseconds now);
    /// Fails where write() would.
    void try_writing();
    /// The last one written.
    std::optional<KeptTime::Mark> mark();
    /// Boards that a former file knew.
    void write_boards(const JournalBoards& boards);

    /// Changes of the boards that `query.board` matches, newest first; `query.state` limits them to changes
    /// into these states. A page may hold fewer than `query.limit` items, or none, and still have a cursor:
    /// then there is more to look at. Error: a sentence on a state or cursor that is none.
    Expected<bus::Answer> find(const bus::Query& query);

    /// Every board that was not forgotten since.
    JournalBoards boards();

  private:
    void write_changes(const std::vector<bus::HistoryItem>& items, std::int64_t kept);
    void write_mark(const KeptTime::Mark& mark);

    Options options_;
    Database database_;
};

}  // namespace asip::registry
