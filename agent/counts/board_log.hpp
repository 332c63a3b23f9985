// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

#include "agent/counts/log_feed.hpp"
#include "asip/program/log.hpp"

namespace asip::agent {

/// The log of one board's agent: each line goes to standard error, those of level info and above also to the
/// topic `$log`, by take(). What is logged while on_news runs is not kept: publishing must not log for ever.
class BoardLog {
  public:
    /// `called`: a field that names the board of each line; none: the process has only one.
    BoardLog(std::optional<std::pair<std::string, std::string>> called, std::function<void()> on_news);

    /// Lines name the board from now on, where they name any.
    void board_is(const std::string& name);

    void write(program::log::Level level, std::string_view text, program::log::Fields fields = {});
    void write(program::log::Level level, std::string_view text, std::span<const program::log::Field> fields);
    void trace(std::string_view text) { write(program::log::Level::kTrace, text); }
    void debug(std::string_view text, program::log::Fields fields = {}) {
        write(program::log::Level::kDebug, text, fields);
    }
    void info(std::string_view text, program::log::Fields fields = {}) {
        write(program::log::Level::kInfo, text, fields);
    }
    void warning(std::string_view text, program::log::Fields fields = {}) {
        write(program::log::Level::kWarning, text, fields);
    }
    void error(std::string_view text, program::log::Fields fields = {}) {
        write(program::log::Level::kError, text, fields);
    }

    /// See LogFeed::take().
    std::vector<std::string> take() { return feed_.take(); }

  private:
    std::optional<std::pair<std::string, std::string>> called_;
    std::function<void()> on_news_;
    LogFeed feed_;
    bool telling_ = false;
};

}  // namespace asip::agent
