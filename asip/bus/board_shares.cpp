// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/board_shares.hpp"

#include <algorithm>

namespace asip::bus {
namespace {

std::size_t bytes_of(const mqtt::Message& message) {
    return message.topic.size() + message.payload.size() + BoardShares::kAround;
}

}  // namespace

void BoardShares::refill(Board& board, Time now) {
    board.left = std::min(kBurst, board.left + (now - board.at) / kPart);
    board.at = now;
}

void BoardShares::message(std::string_view name, const mqtt::Message& message, Time now) {
    auto found = boards_.find(name);
    if (found == boards_.end())
        found = boards_.try_emplace(std::string(name), Board{kBurst, now, {}, 0}).first;
    auto& board = found->second;
    refill(board, now);
    if (board.left <= Duration{} || !board.waiting.empty()) return wait(*found, message);
    const auto began = shares_.now();
    handle_(message);
    board.left -= shares_.now() - began;
}

// What is left has the order in which it came.
void BoardShares::wait(Boards::value_type& of, const mqtt::Message& message) {
    auto& board = of.second;
    const bool first = board.waiting.empty();
    const auto older = std::find_if(board.waiting.begin(), board.waiting.end(),
                                    [&](const auto& each) { return each.topic == message.topic; });
    if (older != board.waiting.end()) drop(board, older);
    board.waiting.push_back(message);
    board.bytes += bytes_of(message);
    while (board.bytes > kMaxBytes && board.waiting.size() > 1)
        drop(board, board.waiting.begin());
    if (first) shares_.add("board " + of.first, [this, name = of.first] { return next(name); });
}

void BoardShares::drop(Board& board, std::list<mqtt::Message>::iterator which) {
    replaced_(which->topic);
    board.bytes -= bytes_of(*which);
    board.waiting.erase(which);
}

bool BoardShares::next(const std::string& name) {
    const auto found = boards_.find(name);
    if (found == boards_.end() || found->second.waiting.empty()) return false;
    auto& board = found->second;
    const auto message = std::move(board.waiting.front());
    board.waiting.pop_front();
    board.bytes -= bytes_of(message);
    const auto began = shares_.now();
    handle_(message);
    board.left -= shares_.now() - began;
    return !board.waiting.empty();
}

void BoardShares::disconnected() {
    for (auto& [name, board] : boards_) {
        board.waiting.clear();
        board.bytes = 0;
    }
}

void BoardShares::tick(Time now) {
    for (auto each = boards_.begin(); each != boards_.end();) {
        auto& board = each->second;
        refill(board, now);
        each = board.waiting.empty() && board.left == kBurst ? boards_.erase(each) : std::next(each);
    }
}

}  // namespace asip::bus
