// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/line_watch.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::agent {
namespace {

/// As UTF-8.
std::string characters_of(std::string_view bytes) {
    std::string text;
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x80) text += static_cast<char>(0xc0 | byte >> 6);
        text += static_cast<char>(byte < 0x80 ? byte : 0x80 | (byte & 0x3f));
    }
    return text;
}

}  // namespace

void LineWatch::add(char direction, std::string_view bytes, Time now) {
    if (now >= until_ || bytes.empty()) return;
    const auto room = std::min(bytes.size(), kMaxBytes - kept_);
    dropped_ += bytes.size() - room;
    kept_ += room;
    if (pieces_.empty()) due_ = std::max(now, told_ + kBetween);
    const bool goes_on =
        !pieces_.empty() && pieces_.back().direction == direction && now < pieces_.back().at + kTogether;
    if (!goes_on && room > 0) pieces_.push_back({direction, now, {}});
    pieces_.back().bytes += bytes.substr(0, room);
}

std::string LineWatch::take(Time now) {
    if (pieces_.empty() || now < due_) return {};
    auto pieces = nlohmann::json::array();
    for (const auto& each : pieces_) {
        const std::chrono::duration<double> age = now - each.at;
        pieces.push_back({std::string(1, each.direction), std::round(age.count() * 1000) / 1000,
                          characters_of(each.bytes)});
    }
    nlohmann::json told{{"line", std::move(pieces)}};
    if (dropped_ > 0) told["dropped"] = dropped_;
    pieces_.clear();
    kept_ = dropped_ = 0;
    told_ = now;
    return model::dump_json(told);
}

}  // namespace asip::agent
