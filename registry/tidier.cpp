// SPDX-License-Identifier: Apache-2.0
#include "registry/tidier.hpp"

#include <utility>

namespace asip::registry {

Tidier::Tidier(const bus::Topics& topics, Port port, IsAlive is_alive)
    : topics_(topics), port_(std::move(port)), is_alive_(std::move(is_alive)) {}

void Tidier::clear(std::string topic) {
    if (denied_topics_.contains(topic)) return;
    port_.publish(mqtt::Message{.topic = std::move(topic), .qos = 1, .retain = true});
}

std::string Tidier::context_filter(const std::string& board) const {
    return topics_.root() + "/" + board + "/#";
}

void Tidier::ghost(std::string board, Time now) {
    ghosts_.emplace_back(now + kGhostDelay, std::move(board));
}

void Tidier::forgotten(std::string board) {
    clear(topics_.description(board));
    clear(topics_.properties(board));
    clear(topics_.state(board));
    clear(topics_.service_names(board));
    to_sweep_.push_back(std::move(board));
}

void Tidier::retained(const std::string& topic, std::string_view board) {
    if (sweeping_.find(board) == sweeping_.end() || to_clear_.size() == kMaxToClear) return;
    to_clear_.push_back(topic);
    if (to_clear_.size() == 1) clear(topic);
}

void Tidier::published(std::string_view topic) {
    if (!to_clear_.empty() && to_clear_.front() == topic) clear_next();
}

void Tidier::clear_next() {
    to_clear_.pop_front();
    clear_until_.reset();
    if (!to_clear_.empty()) clear(to_clear_.front());
}

bool Tidier::denied(const std::string& topic, Time now) {
    const auto known = topics_.parse(topic);
    const bool swept = !to_clear_.empty() && to_clear_.front() == topic;
    const bool of_board =
        known && (known->kind == bus::TopicKind::kDescription || known->kind == bus::TopicKind::kState ||
                  known->kind == bus::TopicKind::kProperties || known->kind == bus::TopicKind::kServiceNames);
    if (!swept && !of_board) return false;
    if (of_board) denied_topics_.insert(topic);
    const bool first = may_sweep(now);
    denied_until_ = now + kDeniedTime;
    end_sweeps();
    return first;
}

void Tidier::end_sweeps() {
    for (const auto& [board, until] : sweeping_)
        port_.unsubscribe(context_filter(board));
    sweeping_.clear();
    to_sweep_.clear();
    to_clear_.clear();
    clear_until_.reset();
}

void Tidier::tick(Time now) {
    if (denied_until_ && now >= *denied_until_) {
        denied_until_.reset();
        denied_topics_.clear();
    }
    while (!ghosts_.empty() && ghosts_.front().first <= now) {
        if (!is_alive_(ghosts_.front().second)) clear(topics_.description(ghosts_.front().second));
        ghosts_.pop_front();
    }
    for (auto sweep = sweeping_.begin(); sweep != sweeping_.end();) {
        // A board that came back keeps its topics.
        if (sweep->second <= now || is_alive_(sweep->first)) {
            port_.unsubscribe(context_filter(sweep->first));
            sweep = sweeping_.erase(sweep);
        } else {
            ++sweep;
        }
    }
    if (!to_clear_.empty()) {
        if (!clear_until_) clear_until_ = now + kClearTime;
        if (now >= *clear_until_) clear_next();
    }
    if (!may_sweep(now)) to_sweep_.clear();
    while (!to_sweep_.empty() && sweeping_.size() < kMaxSweeps) {
        std::string board = std::move(to_sweep_.front());
        to_sweep_.pop_front();
        if (is_alive_(board)) continue;
        port_.subscribe(context_filter(board), true);
        sweeping_.emplace(std::move(board), now + kSweepTime);
    }
}

}  // namespace asip::registry
