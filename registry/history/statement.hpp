// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sqlite3.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace asip::registry {

/// What SQLite says when it cannot. `damaged`: of the file's content, which no later attempt mends.
struct HistoryFault : std::runtime_error {
    HistoryFault(sqlite3* database, int code);
    explicit HistoryFault(const std::string& reason) : std::runtime_error(reason) {}
    bool damaged = false;
};

/// An open SQLite file. Each function throws HistoryFault where it fails.
class Database {
  public:
    explicit Database(const std::string& path);
    operator sqlite3*() const { return file_.get(); }

    void execute(const std::string& sql);
    /// The first column of the first row; 0: there is no row.
    std::int64_t number(const std::string& sql);
    std::size_t used_bytes();
    /// All or nothing. Fails where another file has taken the place of this one, too.
    void in_transaction(const std::function<void()>& write);

  private:
    struct Close {
        void operator()(sqlite3* file) const { sqlite3_close_v2(file); }
    };
    std::unique_ptr<sqlite3, Close> file_;
};

/// A prepared SQLite statement: parameters are bound in order, rows read in order. Each call throws
/// HistoryFault where it fails.
class Statement {
  public:
    Statement(sqlite3* database, const std::string& sql) {
        sqlite3_stmt* statement = nullptr;
        const int result = sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr);
        if (result != SQLITE_OK) throw HistoryFault(database, result);
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
    /// Not a number: null.
    Statement& bind_real(double value) {
        sqlite3_bind_double(statement_.get(), next_++, value);
        return *this;
    }
    Statement& bind_bytes(std::string_view bytes) {
        sqlite3_bind_blob(statement_.get(), next_++, bytes.data(), static_cast<int>(bytes.size()),
                          SQLITE_TRANSIENT);
        return *this;
    }
    /// True: there is a row, to be read with integer() and text().
    bool step() {
        const int result = sqlite3_step(statement_.get());
        if (result == SQLITE_ROW) return true;
        if (result == SQLITE_DONE) return false;
        throw HistoryFault(sqlite3_db_handle(statement_.get()), result);
    }
    std::int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
    /// Null: not a number.
    double real(int column) const {
        if (sqlite3_column_type(statement_.get(), column) == SQLITE_NULL)
            return std::numeric_limits<double>::quiet_NaN();
        return sqlite3_column_double(statement_.get(), column);
    }
    /// Valid until the next step().
    std::string_view bytes(int column) const {
        const auto* begin = static_cast<const char*>(sqlite3_column_blob(statement_.get(), column));
        return {begin, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
    }
    std::string text(int column) const {
        const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
        return text == nullptr ? std::string() : std::string(text);
    }

  private:
    struct Finalize {
        void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
    };
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
    int next_ = 1;
};

}  // namespace asip::registry
