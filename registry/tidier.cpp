#include "registry/tidier.hpp"

#include <utility>

namespace asip::registry {

Tidier::Tidier(const bus::Topics& topics, BusPort bus, IsAlive is_alive)
    : topics_(topics), bus_(std::move(bus)), is_alive_(std::move(is_alive)) {}

void Tidier::empty(std::string topic) {
    mqtt::Message message;
    message.topic = std::move(topic);
    message.retain = true;
    message.qos = 1;
    bus_.publish(std::move(message));
}

std::string Tidier::context_filter(const std::string& board) const {
    return topics_.root() + "/" + board + "/#";
}

void Tidier::ghost(std::string board, Time now) {
    ghosts_.emplace_back(now + kGhostDelay, std::move(board));
}

void Tidier::forgotten(std::string board) {
    empty(topics_.description(board));
    empty(topics_.state(board));
    empty(topics_.service_names(board));
    to_sweep_.push_back(std::move(board));
}

void Tidier::retained(const std::string& topic, std::string_view board) {
    if (sweeping_.find(board) != sweeping_.end()) empty(topic);
}

void Tidier::tick(Time now) {
    while (!ghosts_.empty() && ghosts_.front().first <= now) {
        if (!is_alive_(ghosts_.front().second)) empty(topics_.description(ghosts_.front().second));
        ghosts_.pop_front();
    }
    for (auto sweep = sweeping_.begin(); sweep != sweeping_.end();) {
        // A board that came back is no longer ours to tidy up after.
        if (sweep->second <= now || is_alive_(sweep->first)) {
            bus_.unsubscribe(context_filter(sweep->first));
            sweep = sweeping_.erase(sweep);
        } else {
            ++sweep;
        }
    }
    while (!to_sweep_.empty() && sweeping_.size() < kSweepsAtOnce) {
        std::string board = std::move(to_sweep_.front());
        to_sweep_.pop_front();
        if (is_alive_(board)) continue;
        bus_.subscribe(context_filter(board), true);
        sweeping_.emplace(std::move(board), now + kSweepTime);
    }
}

}  // namespace asip::registry
