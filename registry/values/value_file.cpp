// SPDX-License-Identifier: Apache-2.0
#include "registry/values/value_file.hpp"

#include <algorithm>
#include <limits>

#include "registry/values/value_blocks.hpp"

namespace asip::registry {
namespace {

constexpr Tick kDropEach = kHourTicks;
constexpr int kFileVersion = 1;
constexpr std::int64_t kDroppedAtOnce = 8 << 20;
// The place of a row of this property says since when its part is whole. No property has this number.
constexpr std::int64_t kWholeSince = 0;
constexpr std::size_t kPageBytes = 4096, kMinJournalPages = 100, kMaxJournalPages = 8000;

// In a row, `part` counts the parts of its level, and `at` is within its part.
constexpr const char* kTables =
    "PRAGMA journal_mode=WAL;"
    "PRAGMA synchronous=FULL;"  // one transaction in ten seconds
    // Each of them changes the same pages, of many properties: they stay in memory, 16 MB, and go into the
    // file together.
    "PRAGMA cache_size=-16384;"
    "CREATE TABLE IF NOT EXISTS properties(id INTEGER PRIMARY KEY, board TEXT NOT NULL, property TEXT NOT "
    "NULL, written INTEGER NOT NULL, UNIQUE(board, property));"
    "CREATE TABLE IF NOT EXISTS stretches(start INTEGER PRIMARY KEY, until INTEGER NOT NULL, shift INTEGER "
    "NOT "
    "NULL);"
    "CREATE TABLE IF NOT EXISTS changes(part INTEGER, property INTEGER, at INTEGER, block BLOB NOT NULL, "
    "PRIMARY KEY(part, property, at)) WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS minutes(part INTEGER, property INTEGER, at INTEGER, min REAL, mean REAL, max "
    "REAL, last REAL, known INTEGER, PRIMARY KEY(part, property, at)) WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS hours(part INTEGER, property INTEGER, at INTEGER, min REAL, mean REAL, max "
    "REAL, last REAL, known INTEGER, PRIMARY KEY(part, property, at)) WITHOUT ROWID;";

std::string table_of(Level level) {
    return std::string(to_text(level));
}

std::string bytes_of_row(Level level) {
    return level == Level::kChanges ? "64+length(block)" : "64";
}

}  // namespace

ValueFile::ValueFile(Options options) : options_(std::move(options)), database_(options_.path) {
    const auto version = database_.number("PRAGMA user_version");
    if (version > kFileVersion) throw HistoryFault("a later version of this program wrote it");
    database_.execute(kTables);
    const auto journal_pages =
        std::clamp(options_.max_bytes / 4 / kPageBytes, kMinJournalPages, kMaxJournalPages);
    database_.execute("PRAGMA wal_autocheckpoint=" + std::to_string(journal_pages));
    if (version == 0) database_.execute("PRAGMA user_version=1");
}

std::optional<Tick> ValueFile::last() {
    Statement row(database_, "SELECT until FROM stretches ORDER BY start DESC LIMIT 1");
    if (!row.step()) return std::nullopt;
    return row.integer(0);
}

/// No board takes the places of others.
bool ValueFile::has_room(const std::string& board) {
    if (count_ < 0) count_ = database_.number("SELECT count(*) FROM properties");
    if (count_ >= static_cast<std::int64_t>(kMaxNames)) return false;
    Statement own(database_, "SELECT count(*) FROM properties WHERE board=?");
    own.bind(board);
    return own.step() && own.integer(0) < static_cast<std::int64_t>(kMaxNamesOfBoard);
}

std::optional<std::int64_t> ValueFile::id_of(const PropertyKey& key, Tick at) {
    const Tick part = at - at % kPartTicks[0];
    auto& name = names_[key];
    if (name.id == 0) {
        Statement found(database_, "SELECT id FROM properties WHERE board=? AND property=?");
        found.bind(key.board).bind(key.property);
        if (found.step()) {
            name.id = found.integer(0);
        } else if (!has_room(key.board)) {
            names_.erase(key);
            return std::nullopt;
        } else {
            ++count_;
            Statement(database_, "INSERT INTO properties(board,property,written) VALUES(?,?,?)")
                .bind(key.board)
                .bind(key.property)
                .bind(part)
                .step();
            name = {sqlite3_last_insert_rowid(database_), part};
        }
    }
    if (name.written < part) {
        Statement(database_, "UPDATE properties SET written=? WHERE id=?").bind(part).bind(name.id).step();
        name.written = part;
    }
    return name.id;
}

bool ValueFile::write(const ValueRows& rows) {
    bool all = true;
    try {
        database_.in_transaction([&] {
            for (const auto& each : rows.stretches)
                Statement(database_, "INSERT OR REPLACE INTO stretches(start,until,shift) VALUES(?,?,?)")
                    .bind(each.start)
                    .bind(each.end)
                    .bind(each.offset)
                    .step();
            if (!rows.stretches.empty()) write_properties(rows, all);
        });
        if (!rows.stretches.empty()) drop_old(rows.stretches.back().end);
    } catch (const std::exception&) {
        forget_names();
        throw;
    }
    return all;
}

void ValueFile::write_properties(const ValueRows& given, bool& all) {
    // A block ends where a part or a stretch does.
    const auto next_stretch = [&](Tick at) {
        for (const auto& stretch : given.stretches)
            if (stretch.start > at) return stretch.start;
        return std::numeric_limits<Tick>::max();
    };
    Statement changes(database_, "INSERT OR REPLACE INTO changes(part,property,at,block) VALUES(?,?,?,?)");
    const std::string into = "(part,property,at,min,mean,max,last,known) VALUES(?,?,?,?,?,?,?,?)";
    Statement minutes(database_, "INSERT OR REPLACE INTO minutes" + into);
    Statement hours(database_, "INSERT OR REPLACE INTO hours" + into);
    for (const auto& rows : given.properties) {
        const auto id = id_of(rows.key, given.stretches.back().end);
        all = all && id;
        if (!id) continue;
        for (std::size_t begin = 0, end = 0; begin < rows.changes.size(); begin = end) {
            constexpr Tick kPart = kPartTicks[0];
            const Tick at = rows.changes[begin].at;
            const Tick until = std::min((at / kPart + 1) * kPart, next_stretch(at));
            for (end = begin; end < rows.changes.size() && rows.changes[end].at < until; ++end) {
            }
            const auto block = std::span(rows.changes).subspan(begin, end - begin);
            changes.reset()
                .bind(at / kPart)
                .bind(*id)
                .bind(at % kPart)
                .bind_bytes(pack_changes(block, at))
                .step();
        }
        for (const auto& [level, buckets, statement] : {std::tuple(Level::kMinutes, &rows.minutes, &minutes),
                                                        std::tuple(Level::kHours, &rows.hours, &hours)})
            for (const auto& bucket : *buckets) {
                const Tick part = part_ticks(level);
                statement->reset().bind(bucket.at / part).bind(*id).bind(bucket.at % part);
                statement->bind_real(bucket.min).bind_real(bucket.mean).bind_real(bucket.max);
                statement->bind_real(bucket.last).bind(bucket.known).step();
            }
    }
}

/// Drops the rows of a part; where it is cut, only those behind which there is another up to `cut`.
void ValueFile::drop_rows(Level level, std::int64_t part, std::optional<Tick> cut) {
    const auto table = table_of(level);
    // What goes is written into the journal first: not all of it at once.
    Statement rows(database_, "SELECT property,at," + bytes_of_row(level) + " FROM " + table +
                                  " WHERE part=? AND (property,at)>(?,?) ORDER BY property,at");
    Statement drop(database_,
                   "DELETE FROM " + table +
                       " AS old WHERE part=? AND (property,at)>(?,?) AND (property,at)<=(?,?)" +
                       (cut ? " AND EXISTS(SELECT 1 FROM " + table +
                                  " WHERE part=old.part AND property=old.property AND at>old.at AND at<=?)"
                            : ""));
    std::int64_t property = cut ? kWholeSince : -1, at = std::numeric_limits<Tick>::max();
    for (bool more = true; more;) {
        drop.reset().bind(part).bind(property).bind(at);
        rows.reset().bind(part).bind(property).bind(at);
        for (std::int64_t bytes = 0; bytes < kDroppedAtOnce && (more = rows.step());) {
            property = rows.integer(0);
            at = rows.integer(1);
            bytes += rows.integer(2);
        }
        rows.reset();
        drop.bind(property).bind(at);
        if (cut) drop.bind(*cut);
        drop.step();
    }
}

void ValueFile::say_whole(Level level, std::int64_t part, Tick since) {
    const auto table = table_of(level);
    database_.in_transaction([&] {
        Statement(database_, "DELETE FROM " + table + " WHERE part=? AND property=?")
            .bind(part)
            .bind(kWholeSince)
            .step();
        Statement(database_, "INSERT INTO " + table +
                                 (level == Level::kChanges ? "(part,property,at,block) VALUES(?,?,?,x'')"
                                                           : "(part,property,at) VALUES(?,?,?)"))
            .bind(part)
            .bind(kWholeSince)
            .bind(since)
            .step();
    });
}

std::optional<ValueFile::Oldest> ValueFile::oldest(Level level) {
    Statement row(database_,
                  "SELECT part,property,at FROM " + table_of(level) + " ORDER BY part,property,at LIMIT 1");
    if (!row.step()) return std::nullopt;
    return Oldest{row.integer(0), row.integer(1) == kWholeSince ? row.integer(2) : 0};
}

/// Drops the oldest part of a level; of the last one the older half, but of each property the row that goes
/// on, and these only where they take more than a level's share of the room. False: nothing is to be dropped.
bool ValueFile::drop_oldest(Level level, Tick now) {
    const auto table = table_of(level);
    const auto first = oldest(level);
    if (!first) return false;
    const auto [part, whole] = *first;
    const Tick end = now - part * part_ticks(level);
    if (part != database_.number("SELECT max(part) FROM " + table) || end > part_ticks(level)) {
        drop_rows(level, part, std::nullopt);
        return true;
    }
    if (whole < end) {
        const Tick cut = end - whole < kMinuteTicks ? end : whole + (end - whole) / 2;
        say_whole(level, part, cut);
        drop_rows(level, part, cut);
        return true;
    }
    Statement size(database_, "SELECT total(" + bytes_of_row(level) + ") FROM " + table);
    if (!size.step() || size.real(0) < static_cast<double>(options_.max_bytes / kLevels)) return false;
    drop_rows(level, part, std::nullopt);
    say_whole(level, part, part_ticks(level));
    return true;
}

void ValueFile::drop_old(Tick now) {
    // Where there is no room, what is fine goes first: of the oldest there is something coarser.
    for (const auto level : {Level::kChanges, Level::kMinutes, Level::kHours})
        while (database_.used_bytes() > options_.max_bytes && drop_oldest(level, now)) {
        }
    if (now < dropped_at_ + kDropEach) return;
    dropped_at_ = now;
    for (const auto level : {Level::kChanges, Level::kMinutes, Level::kHours}) {
        const auto first = (now - options_.max_age[static_cast<std::size_t>(level)]) / part_ticks(level);
        while (database_.number("SELECT min(part)<" + std::to_string(first) + " FROM " + table_of(level)) !=
               0)
            drop_rows(level, database_.number("SELECT min(part) FROM " + table_of(level)), std::nullopt);
    }
    const auto oldest =
        now - options_.max_age[static_cast<std::size_t>(Level::kHours)] - part_ticks(Level::kHours);
    Statement(database_, "DELETE FROM stretches WHERE until<?").bind(oldest).step();
    Statement gone(database_, "DELETE FROM properties WHERE written<?");
    gone.bind(oldest).step();
    if (sqlite3_changes(database_) > 0) forget_names();
}

}  // namespace asip::registry
