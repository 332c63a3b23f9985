// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace asip::registry {

/// A prepared SQLite statement: parameters are bound in order, rows read in order. Each call throws
/// std::runtime_error with SQLite's reason where it fails.
class Statement {
  public:
    Statement(sqlite3* database, const std::string& sql) {
        sqlite3_stmt* statement = nullptr;
        if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
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
    /// True: there is a row, to be read with integer() and text().
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
    struct Finalize {
        void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
    };
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
    int next_ = 1;
};

}  // namespace asip::registry
