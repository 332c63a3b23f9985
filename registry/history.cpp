#include "registry/history.hpp"
#include "asip/bus/change_event.hpp"
#include "asip/bus/pattern.hpp"
#include "asip/text/wall_time.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace asip::registry {
namespace {

using text::WallTime;

constexpr std::size_t kBatch = 10'000;
constexpr Duration kWriteInterval = std::chrono::seconds(1);
constexpr Duration kTrimInterval = std::chrono::minutes(1);

constexpr const char* kSchema =
    "PRAGMA auto_vacuum=INCREMENTAL;"  // before anything is written
    "PRAGMA journal_mode=WAL;"
    "PRAGMA synchronous=NORMAL;"
    "CREATE TABLE IF NOT EXISTS boards(name TEXT PRIMARY KEY, first INTEGER NOT NULL, last INTEGER NOT NULL) "
    "WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS changes(id INTEGER PRIMARY KEY, at INTEGER NOT NULL, board TEXT NOT NULL, "
    "what TEXT NOT NULL,"
    " state TEXT NOT NULL, was TEXT NOT NULL, reason TEXT NOT NULL);"
    "CREATE INDEX IF NOT EXISTS changes_of_board ON changes(board, id);";

struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

/// A prepared statement; parameters are bound in order, rows read in order.
class Statement {
  public:
    Statement(sqlite3* database, const char* sql) {
        sqlite3_stmt* statement = nullptr;
        if (sqlite3_prepare_v2(database, sql, -1, &statement, nullptr) != SQLITE_OK) {
            throw std::runtime_error(sqlite3_errmsg(database));
        }
        statement_.reset(statement);
    }
    Statement& reset() {
        sqlite3_reset(statement_.get());
        next_ = 1;
        return *this;
    }
    Statement& bind(std::int64_t value) {
        sqlite3_bind_int64(statement_.get(), next_++, value);
        return *this;
    }
    Statement& bind(std::string_view text) {
        sqlite3_bind_text(statement_.get(), next_++, text.data(), static_cast<int>(text.size()),
                          SQLITE_TRANSIENT);
        return *this;
    }
    /// True: there is a row.
    bool step() {
        const int result = sqlite3_step(statement_.get());
        if (result == SQLITE_ROW) return true;
        if (result == SQLITE_DONE) return false;
        throw std::runtime_error(sqlite3_errmsg(sqlite3_db_handle(statement_.get())));
    }
    std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
    std::string text(int column) const {
        const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
        return text == nullptr ? std::string() : std::string(text);
    }

  private:
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
    int next_ = 1;
};

WallTime wall(std::int64_t milliseconds) {
    return WallTime(std::chrono::milliseconds(milliseconds));
}

}  // namespace

class History::Impl {
  public:
    explicit Impl(Options options) : options_(std::move(options)) {
        if (sqlite3_open(options_.path.c_str(), &database_) != SQLITE_OK) fail_to_open();
        sqlite3_busy_timeout(database_, 1000);
        if (sqlite3_exec(database_, kSchema, nullptr, nullptr, nullptr) != SQLITE_OK) fail_to_open();
    }
    ~Impl() {
        try {
            write();
        } catch (const std::exception&) {
            // Nobody is left to be told; the file stays as the last batch left it.
        }
        sqlite3_close_v2(database_);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void add(const Event& event, WallTime at) {
        bus::HistoryItem item;
        item.board = event.board;
        item.at = at;
        item.what = bus::to_string(static_cast<bus::ChangeEvent::Kind>(event.kind));
        if (event.kind != Event::Kind::kForgotten) item.state = model::to_text(event.state);
        if (event.kind == Event::Kind::kState) item.was = model::to_text(event.was);
        item.reason = to_text(event.reason);
        waiting_.push_back(std::move(item));
        newest_ = std::max(newest_, at);
        if (waiting_.size() >= kBatch) write();
    }

    void tick(Time now) {
        if (now >= next_write_) {
            write();
            next_write_ = now + kWriteInterval;
        }
        if (now >= next_trim_) {
            trim();
            next_trim_ = now + kTrimInterval;
        }
    }

    void write() {
        if (waiting_.empty()) return;
        execute("BEGIN");
        Statement change(database_,
                         "INSERT INTO changes(at,board,what,state,was,reason) VALUES(?,?,?,?,?,?)");
        Statement board(database_,
                        "INSERT INTO boards(name,first,last) VALUES(?,?,?) ON CONFLICT(name) DO UPDATE SET "
                        "last=excluded.last");
        for (const auto& item : waiting_) {
            const std::int64_t at = item.at.time_since_epoch().count();
            change.reset()
                .bind(at)
                .bind(item.board)
                .bind(item.what)
                .bind(item.state)
                .bind(item.was)
                .bind(item.reason);
            change.step();
            board.reset().bind(item.board).bind(at).bind(at);
            board.step();
        }
        execute("COMMIT");
        waiting_.clear();
    }

    void trim() {
        const std::int64_t oldest =
            newest_.time_since_epoch().count() -
            std::chrono::duration_cast<std::chrono::milliseconds>(options_.max_age).count();
        Statement(database_, "DELETE FROM changes WHERE at<?").bind(oldest).step();
        Statement(database_, "DELETE FROM boards WHERE last<?").bind(oldest).step();
        // A tenth at a time, until what is left fits: pages given back can be used again at once.
        for (int round = 0; round < 20 && used_bytes() > options_.max_bytes; ++round) {
            Statement(database_,
                      "DELETE FROM changes WHERE id<=(SELECT min(id)+(max(id)-min(id))/10 FROM changes)")
                .step();
            execute("PRAGMA incremental_vacuum");
        }
    }

    Expected<bus::Answer> find(const bus::Query& query) {
        write();
        std::int64_t before = INT64_MAX;
        if (!query.cursor.empty()) {
            if (query.cursor.size() > 18 ||
                query.cursor.find_first_not_of("0123456789") != std::string::npos) {
                return fail("cursor: not one of this registry's");
            }
            before = std::stoll(query.cursor);
        }
        const bool exact = !query.board.empty() && query.board.find_first_of("*?") == std::string::npos;
        Statement rows(database_,
                       exact ? "SELECT id,at,board,what,state,was,reason FROM changes WHERE id<? AND board=? "
                               "ORDER BY id DESC"
                             : "SELECT id,at,board,what,state,was,reason FROM changes WHERE id<? "
                               "ORDER BY id DESC");
        rows.bind(before);
        if (exact) rows.bind(query.board);
        bus::Answer answer;
        const std::size_t limit = std::clamp<std::size_t>(query.limit, 1, bus::Query::kMaxPage);
        std::int64_t last = 0;
        while (rows.step()) {
            bus::HistoryItem item{rows.text(2), wall(rows.integer(1)), rows.text(3),
                                  rows.text(4), rows.text(5),          rows.text(6)};
            if (!bus::matches_pattern(query.board, item.board)) continue;
            if (!query.state.empty() &&
                std::find(query.state.begin(), query.state.end(), item.state) == query.state.end()) {
                continue;
            }
            if (answer.history.size() == limit) {
                answer.cursor = std::to_string(last);
                break;
            }
            last = rows.integer(0);
            answer.history.push_back(std::move(item));
        }
        return answer;
    }

    std::optional<Seen> seen(const std::string& board) {
        write();
        Statement row(database_, "SELECT first,last FROM boards WHERE name=?");
        row.bind(board);
        if (!row.step()) return std::nullopt;
        return Seen{wall(row.integer(0)), wall(row.integer(1))};
    }

  private:
    [[noreturn]] void fail_to_open() {
        const std::string reason = database_ != nullptr ? sqlite3_errmsg(database_) : "out of memory";
        sqlite3_close_v2(database_);
        throw std::runtime_error("cannot keep history in " + options_.path + ": " + reason);
    }
    void execute(const char* sql) {
        if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
            throw std::runtime_error(sqlite3_errmsg(database_));
        }
    }
    std::int64_t pragma(const char* sql) {
        Statement row(database_, sql);
        return row.step() ? row.integer(0) : 0;
    }
    std::size_t used_bytes() {
        const auto pages = pragma("PRAGMA page_count") - pragma("PRAGMA freelist_count");
        return static_cast<std::size_t>(pages * pragma("PRAGMA page_size"));
    }

    Options options_;
    sqlite3* database_ = nullptr;
    std::vector<bus::HistoryItem> waiting_;
    WallTime newest_{};
    Time next_write_{};
    Time next_trim_{};
};

History::History(Options options) : impl_(std::make_unique<Impl>(std::move(options))) {}
History::~History() = default;
void History::add(const Event& event, text::WallTime at) {
    impl_->add(event, at);
}
void History::tick(Time now) {
    impl_->tick(now);
}
Expected<bus::Answer> History::find(const bus::Query& query) {
    return impl_->find(query);
}
std::optional<History::Seen> History::seen(const std::string& board) {
    return impl_->seen(board);
}

}  // namespace asip::registry
