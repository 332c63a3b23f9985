#include "registry/traffic_listener.hpp"

#include <utility>

namespace asip::registry {

TrafficListener::TrafficListener(const bus::Topics& topics, BusPort bus)
    : topics_(topics), bus_(std::move(bus)) {}

void TrafficListener::listen(const std::string& board, Time now) {
    waiting_.emplace(board, now + kDelay);
}

void TrafficListener::unlisten(const std::string& board) {
    waiting_.erase(board);
    if (listening_.erase(board) == 0 || to_all_) return;
    bus_.unsubscribe(topics_.board_out(board));
    bus_.unsubscribe(topics_.service_out(board, "+"));
}

void TrafficListener::tick(Time now) {
    for (auto board = waiting_.begin(); board != waiting_.end();) {
        if (now < board->second) {
            ++board;
            continue;
        }
        listening_.insert(board->first);
        if (!to_all_ && listening_.size() <= kMost) {
            bus_.subscribe(topics_.board_out(board->first), false);
            bus_.subscribe(topics_.service_out(board->first, "+"), false);
        } else if (!to_all_) {
            to_all_ = true;
            bus_.subscribe(topics_.board_out("+"), false);
            bus_.subscribe(topics_.service_out("+", "+"), false);
        }
        board = waiting_.erase(board);
    }
}

}  // namespace asip::registry
