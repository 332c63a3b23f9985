// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

#include "agent/counts/log_feed.hpp"
#include "asip/program/log.hpp"

namespace asip::agent {

/// The log of one board's agent. Each line goes to standard error; a line of level info or above is kept for
/// the topic `$log`, too, until take(). A line that is logged while on_news runs is not kept: publishing must
/// not log for ever.
class BoardLog {
  public:
    /// `called`: which board each line is about, a field; none: the process has only one. `on_news`: there
    /// may be something to publish.
    BoardLog(std::optional<std::pair<std::string, std::string>> called, std::function<void()> on_news);

    /// The board's name is known: lines name it from now on, where they name anything.
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

    /// Payloads for `$log`, as LogFeed::take().
    std::vector<std::string> take() { return feed_.take(); }

  private:
    std::optional<std::pair<std::string, std::string>> called_;
    std::function<void()> on_news_;
    LogFeed feed_;
    bool telling_ = false;
};

}  // namespace asip::agent
