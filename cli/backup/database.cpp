// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include "cli/backup/machine.hpp"
#include "cli/backup/sealed.hpp"

namespace asip::cli {
namespace {

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close_v2)>;
constexpr int kPatienceMs = 10'000;

/// A folder on a disk, of the user that this program is now. Others may write above it, and change nothing in
/// it.
class WorkFolder {
  public:
    WorkFolder() {
        if (::mkdtemp(path_.data()) == nullptr) path_.clear();
    }
    ~WorkFolder() {
        std::error_code ignored;
        if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
    }
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;
    std::string file() const { return path_ + "/copy.db"; }

  private:
    std::string path_ = "/var/tmp/asip-XXXXXX";
};

/// SQLite waits for the other end of a pipe.
bool is_plain(const std::string& path) {
    struct stat status{};
    for (const char* end : {"", "-journal", "-wal", "-shm"})
        if (::lstat((path + end).c_str(), &status) == 0 ? !S_ISREG(status.st_mode) : errno != ENOENT)
            return false;
    return true;
}

Database open_database(const std::string& path, int flags) {
    sqlite3* database = nullptr;
    if (!is_plain(path)) return {nullptr, sqlite3_close_v2};
    sqlite3_open_v2(path.c_str(), &database, flags | SQLITE_OPEN_NOFOLLOW, nullptr);
    sqlite3_busy_timeout(database, kPatienceMs);
    return {database, sqlite3_close_v2};
}

tl::unexpected<Failure> said_of(const std::string& path, sqlite3* database) {
    return failure(program::kExitFailure,
                   path + (database == nullptr ? ": it, or a file beside it, is no plain file"
                                               : std::string(": ") + sqlite3_errmsg(database)));
}

Outcome<void> copy(const std::string& from, const std::string& to, const Database& into) {
    const auto source = open_database(from, SQLITE_OPEN_READONLY);
    if (!source || !into) return said_of(source ? to : from, nullptr);
    auto* copying = sqlite3_backup_init(into.get(), "main", source.get(), "main");
    if (copying == nullptr) return said_of(to, into.get());
    sqlite3_backup_step(copying, -1);
    if (sqlite3_backup_finish(copying) == SQLITE_OK) return {};
    return sqlite3_errcode(source.get()) != SQLITE_OK ? said_of(from, source.get()) : said_of(to, into.get());
}

}  // namespace

Outcome<Descriptor> BackupMachine::copy_database(const BackupItem& item) const {
    const AsUser as(user_for(item));
    const WorkFolder work;
    auto done = copy(name_of(item), work.file(),
                     open_database(work.file(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE));
    if (!done) return tl::unexpected(done.error());
    return Descriptor(::open(work.file().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
}

bool BackupMachine::goes_on_here(const BackupItem& item) const {
    const AsUser as(user_for(item));
    const auto here = open_database(name_of(item), SQLITE_OPEN_READONLY);
    // Times of day, in milliseconds.
    const char* const bounds = item.path == "history.db"
                                   ? "SELECT (SELECT at FROM changes ORDER BY id LIMIT 1),"
                                     "(SELECT at FROM changes ORDER BY id DESC LIMIT 1)"
                                   : "SELECT min(start+shift),max(until+shift) FROM stretches";
    sqlite3_stmt* row = nullptr;
    bool result = true;
    if (here && sqlite3_prepare_v2(here.get(), bounds, -1, &row, nullptr) == SQLITE_OK &&
        sqlite3_step(row) == SQLITE_ROW) {
        constexpr std::int64_t kNanosecondsOfOne = 1'000'000;
        const auto made = item.changed / kNanosecondsOfOne;
        result = sqlite3_column_type(row, 0) != SQLITE_NULL && sqlite3_column_int64(row, 0) < made &&
                 sqlite3_column_int64(row, 1) > made;
    }
    sqlite3_finalize(row);
    return result;
}

Outcome<void> BackupMachine::restore_database(const BackupItem& item, const Descriptor& text) const {
    if (const auto there = look(item); !there || !*there)
        if (auto made = there ? write(item, "") : tl::unexpected(there.error()); !made) return made;
    const AsUser as(user_for(item));
    const WorkFolder work;
    {
        const Descriptor copied(::open(work.file().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
        const bool whole =
            each_part(text, item.at, item.size, [&](std::string_view part) { return copied.write(part); });
        if (!whole) return failure(program::kExitFailure, work.file() + ": " + std::strerror(errno));
    }
    const auto into = open_database(name_of(item), SQLITE_OPEN_READWRITE);
    if (!into) return said_of(name_of(item), nullptr);
    sqlite3_busy_timeout(into.get(), 0);
    // A program that has it open has names and places of its rows in mind.
    if (sqlite3_exec(into.get(), "PRAGMA locking_mode=EXCLUSIVE;BEGIN EXCLUSIVE;COMMIT", nullptr, nullptr,
                     nullptr) == SQLITE_BUSY)
        return failure(program::kExitFailure,
                       name_of(item) + " is in use: stop asip-registry first (systemctl stop asip-registry)");
    return copy(work.file(), name_of(item), into);
}

}  // namespace asip::cli
