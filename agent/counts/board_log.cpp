// SPDX-License-Identifier: Apache-2.0
#include "agent/counts/board_log.hpp"

#include <algorithm>
#include <utility>

#include "asip/text/wall_time.hpp"

namespace asip::agent {

namespace log = program::log;

BoardLog::BoardLog(std::optional<std::pair<std::string, std::string>> called, std::function<void()> on_news)
    : called_(std::move(called)), on_news_(std::move(on_news)) {}

void BoardLog::board_is(const std::string& name) {
    if (called_ && !name.empty()) called_ = {"board", name};
}

void BoardLog::write(log::Level level, std::string_view text, log::Fields fields) {
    write(level, text, std::span<const log::Field>(fields.begin(), fields.size()));
}

void BoardLog::write(log::Level level, std::string_view text, std::span<const log::Field> fields) {
    const bool for_bus = level >= log::Level::kInfo;
    if (!for_bus && !log::enabled(level)) return;
    std::vector<log::Field> all;
    const auto named = [&](const log::Field& field) { return field.name == called_->first; };
    if (called_ && std::none_of(fields.begin(), fields.end(), named))
        all.emplace_back(called_->first, called_->second);
    all.insert(all.end(), fields.begin(), fields.end());
    // Published from in between, what that logs is only printed.
    if (for_bus && !std::exchange(telling_, true)) {
        feed_.add(level, text, all, text::iso_time(text::wall_now()), Clock::now());
        on_news_();
        telling_ = false;
    }
    log::write(level, text, all);
}

}  // namespace asip::agent
