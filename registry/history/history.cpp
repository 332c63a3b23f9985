// SPDX-License-Identifier: Apache-2.0
#include "registry/history/history.hpp"

#include <algorithm>

#include "registry/history/statement.hpp"

namespace asip::registry {
namespace {

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

constexpr const char* kWriteBoard =
    "INSERT INTO boards(name,first,last,state,since) VALUES(?1,?2,?2,?3,?2) ON CONFLICT(name) DO UPDATE SET "
    "first=CASE state WHEN '' THEN ?2 ELSE first END, since=CASE state WHEN ?3 THEN since ELSE ?2 END, "
    "last=?2, state=?3";

}  // namespace

History::History(Options options) : options_(std::move(options)) {
    if (sqlite3_open(options_.path.c_str(), &database_) != SQLITE_OK) fail_to_open();
    sqlite3_busy_timeout(database_, 1000);
    if (sqlite3_exec(database_, kSchema, nullptr, nullptr, nullptr) != SQLITE_OK) fail_to_open();
    for (const auto& [version, upgrade] : {std::pair(0, kUpgradeFrom0), std::pair(1, kUpgradeFrom1)}) {
        if (pragma("PRAGMA user_version") == version &&
            sqlite3_exec(database_, upgrade, nullptr, nullptr, nullptr) != SQLITE_OK) {
            fail_to_open();
        }
    }
}

History::~History() {
    sqlite3_close_v2(database_);
}

void History::fail_to_open() {
    const std::string reason = database_ != nullptr ? sqlite3_errmsg(database_) : "out of memory";
    sqlite3_close_v2(database_);
    throw std::runtime_error("cannot keep history in " + options_.path + ": " + reason);
}

void History::write(const std::vector<bus::HistoryItem>& items) {
    if (items.empty()) return;
    Statement change(
        database_,
        "INSERT INTO changes(at,board,what,state,was,reason,sender,service,request,status,count) "
        "VALUES(?,?,?,?,?,?,?,?,?,?,?)");
    Statement board(database_, kWriteBoard);
    execute("BEGIN");
    try {
        for (const auto& item : items) {
            const std::int64_t at = item.at.time_since_epoch().count();
            change.reset().bind(at).bind(item.board).bind(item.what).bind(item.state).bind(item.was);
            change.bind(item.reason).bind(item.by).bind(item.service).bind(item.request).bind(item.status);
            change.bind(item.count).step();
            if (item.is_command()) continue;  // changes nothing of the board
            board.reset().bind(item.board).bind(at).bind(item.state).step();
        }
        execute("COMMIT");
    } catch (const std::exception&) {
        sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
        throw;
    }
}

void History::trim(text::WallTime now) {
    const std::int64_t oldest =
        now.time_since_epoch().count() -
        std::chrono::duration_cast<std::chrono::milliseconds>(options_.max_age).count();
    // By number: there is no index of times, and numbers grow with them.
    Statement(
        database_,
        "DELETE FROM changes WHERE id<coalesce((SELECT id FROM changes WHERE at>=? ORDER BY id LIMIT 1),"
        "(SELECT max(id)+1 FROM changes))")
        .bind(oldest)
        .step();
    Statement(database_, "DELETE FROM boards WHERE last<? AND state IN ('','lost','offline')")
        .bind(oldest)
        .step();
    // A tenth at a time, until what is left fits: pages given back can be used again at once.
    for (int round = 0; round < 20 && used_bytes() > options_.max_bytes; ++round) {
        execute("DELETE FROM changes WHERE id<=(SELECT min(id)+(max(id)-min(id))/10 FROM changes)");
        execute("PRAGMA incremental_vacuum");
    }
}

JournalBoards History::boards() {
    const auto wall = [](std::int64_t milliseconds) {
        return text::WallTime(std::chrono::milliseconds(milliseconds));
    };
    JournalBoards boards;
    Statement rows(database_, "SELECT name,first,since,state FROM boards WHERE state<>'' ORDER BY name");
    while (rows.step()) {
        const auto state = model::board_state_from_text(rows.text(3));
        if (!state) continue;
        boards.emplace_hint(boards.end(), rows.text(0),
                            JournalBoard{wall(rows.integer(1)), wall(rows.integer(2)), *state});
    }
    return boards;
}

void History::execute(const char* sql) {
    if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
        throw std::runtime_error(sqlite3_errmsg(database_));
    }
}

std::int64_t History::pragma(const char* sql) {
    Statement row(database_, sql);
    return row.step() ? row.integer(0) : 0;
}

std::size_t History::used_bytes() {
    const auto pages = pragma("PRAGMA page_count") - pragma("PRAGMA freelist_count");
    return static_cast<std::size_t>(pages * pragma("PRAGMA page_size"));
}

}  // namespace asip::registry
