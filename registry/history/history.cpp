// SPDX-License-Identifier: Apache-2.0
#include "registry/history/history.hpp"

#include <algorithm>

#include "registry/history/statement.hpp"

namespace asip::registry {
namespace {

constexpr std::int64_t kHistoryVersion = 3;

// `boards.state` is empty for a board that was forgotten: its name stays as long as it has changes.
constexpr const char* kSchema =
    "PRAGMA auto_vacuum=INCREMENTAL;"  // before anything is written
    "PRAGMA journal_mode=WAL;"
    "PRAGMA synchronous=NORMAL;"
    "CREATE TABLE IF NOT EXISTS boards(name TEXT PRIMARY KEY, first INTEGER NOT NULL, last INTEGER NOT NULL) "
    "WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS changes(id INTEGER PRIMARY KEY, at INTEGER NOT NULL, board TEXT NOT NULL, "
    "what TEXT NOT NULL,"
    " state TEXT NOT NULL, was TEXT NOT NULL, reason TEXT NOT NULL);"
    "CREATE INDEX IF NOT EXISTS changes_of_board ON changes(board, id);"
    "CREATE INDEX IF NOT EXISTS changes_into_state ON changes(state, id);";

// Version 0 kept no states of boards: each has that of its last change.
constexpr const char* kUpgradeFrom0 =
    "BEGIN;"
    "ALTER TABLE boards ADD COLUMN state TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE boards ADD COLUMN since INTEGER NOT NULL DEFAULT 0;"
    "UPDATE boards SET since=last, state=coalesce((SELECT state FROM changes WHERE board=name "
    "ORDER BY id DESC LIMIT 1),'');"
    "PRAGMA user_version=1;"
    "COMMIT";

// Version 1 kept no commands.
constexpr const char* kUpgradeFrom1 =
    "BEGIN;"
    "ALTER TABLE changes ADD COLUMN sender TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE changes ADD COLUMN service TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE changes ADD COLUMN request TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE changes ADD COLUMN status TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE changes ADD COLUMN count INTEGER NOT NULL DEFAULT 0;"
    "PRAGMA user_version=2;"
    "COMMIT";

// Version 2 measured ages by the time of day. What it kept is as old as the file's new time.
constexpr const char* kUpgradeFrom2 =
    "BEGIN;"
    "ALTER TABLE changes ADD COLUMN kept INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE boards ADD COLUMN first_kept INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE boards ADD COLUMN since_kept INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE boards ADD COLUMN last_kept INTEGER NOT NULL DEFAULT 0;"
    "CREATE TABLE clock(id INTEGER PRIMARY KEY, kept INTEGER NOT NULL, wall INTEGER NOT NULL, "
    "proven INTEGER NOT NULL, boot TEXT NOT NULL, monotonic INTEGER NOT NULL);"
    "PRAGMA user_version=3;"
    "COMMIT";

constexpr const char* kWriteBoard =
    "INSERT INTO boards(name,first,last,state,since,first_kept,last_kept,since_kept) "
    "VALUES(?1,?2,?2,?3,?2,?4,?4,?4) ON CONFLICT(name) DO UPDATE SET "
    "first=CASE state WHEN '' THEN ?2 ELSE first END, since=CASE state WHEN ?3 THEN since ELSE ?2 END, "
    "first_kept=CASE state WHEN '' THEN ?4 ELSE first_kept END, "
    "since_kept=CASE state WHEN ?3 THEN since_kept ELSE ?4 END, last=?2, last_kept=?4, state=?3";

}  // namespace

HistoryFault::HistoryFault(sqlite3* database, int code)
    : std::runtime_error(sqlite3_errmsg(database)),
      damaged((code & 0xff) == SQLITE_CORRUPT || (code & 0xff) == SQLITE_NOTADB) {}

Database::Database(const std::string& path) {
    sqlite3* file = nullptr;
    const int result = sqlite3_open(path.c_str(), &file);
    file_.reset(file);
    if (file == nullptr) throw HistoryFault("out of memory");
    if (result != SQLITE_OK) throw HistoryFault(file, result);
    sqlite3_busy_timeout(file, 1000);
}

void Database::execute(const std::string& sql) {
    const int result = sqlite3_exec(*this, sql.c_str(), nullptr, nullptr, nullptr);
    if (result != SQLITE_OK) throw HistoryFault(*this, result);
}

std::int64_t Database::number(const std::string& sql) {
    Statement row(*this, sql);
    return row.step() ? row.integer(0) : 0;
}

std::size_t Database::used_bytes() {
    const auto pages = number("PRAGMA page_count") - number("PRAGMA freelist_count");
    return static_cast<std::size_t>(pages * number("PRAGMA page_size"));
}

void Database::in_transaction(const std::function<void()>& write) {
    int moved = 0;
    sqlite3_file_control(*this, "main", SQLITE_FCNTL_HAS_MOVED, &moved);
    if (moved != 0) throw HistoryFault("the file was moved or deleted");
    execute("BEGIN");
    try {
        write();
        execute("COMMIT");
    } catch (const std::exception&) {
        sqlite3_exec(*this, "ROLLBACK", nullptr, nullptr, nullptr);
        throw;
    }
}

History::History(Options options) : options_(std::move(options)), database_(options_.path) {
    if (database_.number("PRAGMA user_version") > kHistoryVersion)
        throw HistoryFault("a later version of this program wrote it");
    database_.execute(kSchema);
    for (const auto& [version, upgrade] :
         {std::pair(0, kUpgradeFrom0), std::pair(1, kUpgradeFrom1), std::pair(2, kUpgradeFrom2)}) {
        if (database_.number("PRAGMA user_version") == version) database_.execute(upgrade);
    }
}

void History::write(const std::vector<bus::HistoryItem>& items, const KeptTime::Mark& mark) {
    database_.in_transaction([&] {
        write_changes(items, mark.kept.count());
        write_mark(mark);
    });
}

void History::write_changes(const std::vector<bus::HistoryItem>& items, std::int64_t kept) {
    if (items.empty()) return;
    Statement change(
        database_,
        "INSERT INTO changes(at,board,what,state,was,reason,sender,service,request,status,count,kept) "
        "VALUES(?,?,?,?,?,?,?,?,?,?,?,?)");
    Statement board(database_, kWriteBoard);
    for (const auto& item : items) {
        const std::int64_t at = item.at.time_since_epoch().count();
        change.reset().bind(at).bind(item.board).bind(item.what).bind(item.state).bind(item.was);
        change.bind(item.reason).bind(item.by).bind(item.service).bind(item.request).bind(item.status);
        change.bind(item.count).bind(kept).step();
        if (item.is_command()) continue;  // changes nothing of the board
        board.reset().bind(item.board).bind(at).bind(item.state).bind(kept).step();
    }
}

void History::write_mark(const KeptTime::Mark& mark) {
    Statement(database_,
              "INSERT OR REPLACE INTO clock(id,kept,wall,proven,boot,monotonic) VALUES(0,?,?,?,?,?)")
        .bind(mark.kept.count())
        .bind(mark.wall.time_since_epoch().count())
        .bind(mark.proven ? 1 : 0)
        .bind(mark.boot)
        .bind(mark.monotonic.count())
        .step();
}

void History::try_writing() {
    database_.in_transaction([&] { database_.execute("PRAGMA user_version=3"); });
}

std::optional<KeptTime::Mark> History::mark() {
    Statement row(database_, "SELECT kept,wall,proven,boot,monotonic FROM clock WHERE id=0");
    if (!row.step()) return std::nullopt;
    return KeptTime::Mark{std::chrono::milliseconds(row.integer(0)),
                          text::WallTime(std::chrono::milliseconds(row.integer(1))), row.integer(2) != 0,
                          row.text(3), std::chrono::milliseconds(row.integer(4))};
}

void History::trim(KeptTime::Milliseconds now) {
    const std::int64_t oldest =
        (now - std::chrono::duration_cast<std::chrono::milliseconds>(options_.max_age)).count();
    // By number: there is no index of times, and numbers grow with them.
    Statement(
        database_,
        "DELETE FROM changes WHERE id<coalesce((SELECT id FROM changes WHERE kept>=? ORDER BY id LIMIT 1),"
        "(SELECT max(id)+1 FROM changes))")
        .bind(oldest)
        .step();
    Statement(database_, "DELETE FROM boards WHERE last_kept<? AND state IN ('','lost','offline')")
        .bind(oldest)
        .step();
    // A tenth at a time, until what is left fits: pages given back can be used again at once.
    for (int round = 0; round < 20 && database_.used_bytes() > options_.max_bytes; ++round) {
        database_.execute("DELETE FROM changes WHERE id<=(SELECT min(id)+(max(id)-min(id))/10 FROM changes)");
        database_.execute("PRAGMA incremental_vacuum");
    }
}

JournalBoards History::boards() {
    const auto wall = [](std::int64_t milliseconds) {
        return text::WallTime(std::chrono::milliseconds(milliseconds));
    };
    JournalBoards boards;
    Statement rows(
        database_,
        "SELECT name,first,since,state,first_kept,since_kept FROM boards WHERE state<>'' ORDER BY name");
    while (rows.step()) {
        const auto state = model::board_state_from_text(rows.text(3));
        if (!state) continue;
        boards.emplace_hint(boards.end(), rows.text(0),
                            JournalBoard{wall(rows.integer(1)), wall(rows.integer(2)), *state,
                                         std::chrono::milliseconds(rows.integer(4)),
                                         std::chrono::milliseconds(rows.integer(5))});
    }
    return boards;
}

void History::write_boards(const JournalBoards& boards) {
    database_.in_transaction([&] {
        Statement row(
            database_,
            "INSERT OR REPLACE INTO boards(name,first,last,state,since,first_kept,last_kept,since_kept) "
            "VALUES(?1,?2,?3,?4,?3,?5,?6,?6)");
        for (const auto& [name, board] : boards) {
            row.reset().bind(name).bind(board.first.time_since_epoch().count());
            row.bind(board.since.time_since_epoch().count()).bind(model::to_text(board.state));
            row.bind(board.first_kept.count()).bind(board.since_kept.count()).step();
        }
    });
}

}  // namespace asip::registry
