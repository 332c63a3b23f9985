// SPDX-License-Identifier: Apache-2.0
#include "agent/counts/log_feed.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::agent {

void LogFeed::add(program::log::Level level, std::string_view text,
                  std::span<const program::log::Field> fields, const std::string& time, Time now) {
    if (!allowance_.take(now)) return;
    nlohmann::json line = nlohmann::json::object();
    for (const auto& field : fields)
        line[std::string(field.name)] = field.value.substr(0, kMaxTextBytes);
    line["time"] = time;
    line["level"] = program::log::name_of(level);
    line["text"] = text.substr(0, kMaxTextBytes);
    if (const auto dropped = allowance_.take_dropped(); dropped > 0) line["dropped"] = dropped;
    kept_.push_back(model::dump_json(line));
    if (kept_.size() > kMaxKept) kept_.pop_front();
}

std::vector<std::string> LogFeed::take() {
    std::vector<std::string> lines(kept_.begin(), kept_.end());
    kept_.clear();
    return lines;
}

}  // namespace asip::agent
