// SPDX-License-Identifier: Apache-2.0
#include "agent/counts/log_feed.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"

namespace asip::agent {

void LogFeed::add(program::log::Level level, std::string_view text,
                  std::span<const program::log::Field> fields, const std::string& time, Time now) {
    if (last_)
        allowance_ =
            std::min(kBurst, allowance_ + kPerSecond * std::chrono::duration<double>(now - *last_).count());
    last_ = now;
    if (allowance_ < 1) {
        ++dropped_;
        return;
    }
    allowance_ -= 1;
    nlohmann::json line = nlohmann::json::object();
    for (const auto& field : fields)
        line[std::string(field.name)] = field.value.substr(0, kMaxTextBytes);
    line["time"] = time;
    line["level"] = program::log::name_of(level);
    line["text"] = text.substr(0, kMaxTextBytes);
    if (dropped_ > 0) line["dropped"] = std::exchange(dropped_, 0u);
    kept_.push_back(model::dump_json(line));
    if (kept_.size() > kMaxKept) kept_.pop_front();
}

std::vector<std::string> LogFeed::take() {
    std::vector<std::string> lines(kept_.begin(), kept_.end());
    kept_.clear();
    return lines;
}

}  // namespace asip::agent
