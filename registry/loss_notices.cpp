// SPDX-License-Identifier: Apache-2.0
#include "registry/loss_notices.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "asip/text/wall_time.hpp"

namespace asip::registry {
namespace {

/// 2000 as 2,000.
std::string grouped(std::size_t number) {
    auto text = std::to_string(number);
    for (auto place = static_cast<long>(text.size()) - 3; place > 0; place -= 3)
        text.insert(static_cast<std::size_t>(place), ",");
    return text;
}

std::string boards(std::size_t count) {
    return count == 1 ? "1 board" : grouped(count) + " boards";
}

/// The machines, the one with most boards first.
std::vector<std::pair<std::string, std::size_t>> in_order(const std::map<std::string, std::size_t>& hosts) {
    std::vector<std::pair<std::string, std::size_t>> all(hosts.begin(), hosts.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& one, const auto& other) { return one.second > other.second; });
    return all;
}

/// `, all behind host vm`, or `: 2 behind host vm, 1 behind host pi, 4 elsewhere`.
std::string where(const std::map<std::string, std::size_t>& hosts, std::size_t count) {
    constexpr std::size_t kMaxInText = 3;
    if (hosts.empty()) return {};
    const auto all = in_order(hosts);
    if (all.front().second == count) return ", all behind host " + all.front().first;
    std::string text;
    for (std::size_t i = 0; i < std::min(all.size(), kMaxInText); ++i) {
        text += (i == 0 ? ": " : ", ") + grouped(all[i].second) + " behind host " + all[i].first;
        count -= all[i].second;
    }
    return count == 0 ? text : text + ", " + grouped(count) + " elsewhere";
}

}  // namespace

void LossNotices::note(const std::string& board, Change change, Instant now) {
    change.at = now.wall;
    waiting_[board] = std::move(change);
    if (!since_) since_ = now.time;
}

void LossNotices::lost(const std::string& board, std::string host, model::StateReason reason, Instant now) {
    const auto found = waiting_.find(board);
    if (told_.contains(board)) {
        // It is known as lost: that it was back meanwhile is not told.
        if (found != waiting_.end() && !found->second.lost) waiting_.erase(found);
        return;
    }
    if (found == waiting_.end() && (waiting_.size() >= kMaxKept || told_.size() >= kMaxKept)) {
        ++more_lost_;
        if (!since_) since_ = now.time;
        return;
    }
    note(board, {true, std::move(host), reason}, now);
}

void LossNotices::back(const std::string& board, Instant now) {
    if (told_.contains(board)) return note(board, {false}, now);
    const auto found = waiting_.find(board);
    if (found != waiting_.end() && found->second.lost) waiting_.erase(found);
}

void LossNotices::forgotten(const std::string& board) {
    told_.erase(board);
    const auto found = waiting_.find(board);
    if (found != waiting_.end() && !found->second.lost) waiting_.erase(found);
}

std::optional<std::string> LossNotices::next(Instant now) {
    if (waiting_.empty() && more_lost_ == 0) since_.reset();
    if (under_way_ || !since_ || now.time < *since_ + kGather || now.time < not_before_) return std::nullopt;
    sent_ = std::exchange(waiting_, {});
    more_lost_sent_ = std::exchange(more_lost_, 0);
    since_.reset();
    under_way_ = true;
    for (const auto& [board, change] : sent_)
        change.lost ? void(told_.insert(board)) : void(told_.erase(board));
    return message(now);
}

void LossNotices::delivered(Time now) {
    sent_.clear();
    more_lost_sent_ = 0;
    under_way_ = false;
    retry_ = kFirstRetry;
    not_before_ = now + kApart;
}

void LossNotices::failed(Time now, Duration wait) {
    for (auto& [board, change] : sent_)
        waiting_.try_emplace(board, std::move(change));  // what is newer stays
    sent_.clear();
    more_lost_ += std::exchange(more_lost_sent_, 0);
    under_way_ = false;
    since_ = now - kGather;
    not_before_ = now + std::max(retry_, wait);
    retry_ = std::min(2 * retry_, kMaxRetry);
}

std::string LossNotices::text() const {
    std::map<std::string, std::size_t> hosts;
    std::vector<const Changes::value_type*> gone, again;
    for (const auto& one : sent_) {
        (one.second.lost ? gone : again).push_back(&one);
        if (one.second.lost && !one.second.host.empty()) ++hosts[one.second.host];
    }
    constexpr std::size_t kMaxInText = 5;
    const auto names = [](const std::vector<const Changes::value_type*>& all) {
        std::string text;
        for (const auto* one : all)
            text += (text.empty() ? "" : ", ") + one->first;
        return text;
    };
    std::string text;
    const auto lost = gone.size() + more_lost_sent_;
    if (lost == 1 && more_lost_sent_ == 0) {
        const auto& [board, change] = *gone.front();
        const auto why = model::words_of(change.reason);
        text = board + " is lost" + (why.empty() ? "" : ": " + std::string(why)) +
               (change.host.empty() ? "" : " (behind host " + change.host + ")");
    } else if (lost > 0) {
        text = boards(lost) + " lost" + where(hosts, lost);
        if (lost <= kMaxInText && more_lost_sent_ == 0) text += " (" + names(gone) + ")";
    }
    if (again.empty()) return text;
    if (!text.empty()) text += "; ";
    if (again.size() == 1) return text + again.front()->first + " is back";
    return text + boards(again.size()) + " back" +
           (again.size() <= kMaxInText ? " (" + names(again) + ")" : "");
}

std::string LossNotices::message(Instant now) const {
    nlohmann::json gone{{"count", more_lost_sent_}, {"boards", nlohmann::json::array()}};
    nlohmann::json again{{"count", 0}, {"boards", nlohmann::json::array()}};
    std::map<std::string, std::size_t> hosts;
    for (const auto& [board, change] : sent_) {
        auto& part = change.lost ? gone : again;
        part["count"] = part["count"].get<std::size_t>() + 1;
        if (change.lost && !change.host.empty()) ++hosts[change.host];
        if (part["boards"].size() >= kMaxNamed) continue;
        nlohmann::json one{{"board", board}, {"since", text::iso_time(change.at)}};
        if (!change.host.empty()) one["host"] = change.host;
        if (change.reason != model::StateReason::kNone) one["reason"] = model::to_text(change.reason);
        part["boards"].push_back(std::move(one));
    }
    gone["hosts"] = nlohmann::json::object();
    for (const auto& [host, count] : in_order(hosts))
        if (gone["hosts"].size() < kMaxNamed) gone["hosts"][host] = count;
    const nlohmann::json message{{"text", text()},
                                 {"registry", registry_},
                                 {"time", text::iso_time(now.wall)},
                                 {"lost", std::move(gone)},
                                 {"back", std::move(again)}};
    return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace asip::registry
