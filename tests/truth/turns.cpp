// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/turns.hpp"

#include <fmt/format.h>

namespace truth {

void Turns::gone(unsigned client, std::size_t command) {
    const auto queue = waiting_.find(client);
    if (queue == waiting_.end()) return;
    queue->second.erase(command);
    if (!queue->second.empty()) return;
    waiting_.erase(queue);
    passed_.erase(client);
}

void Turns::all_gone() {
    waiting_.clear();
    passed_.clear();
}

std::optional<std::string> Turns::sent(unsigned client, std::size_t command) {
    if (!known_) return std::nullopt;
    std::optional<std::string> wrong;
    if (const auto queue = waiting_.find(client); queue != waiting_.end() && *queue->second.begin() < command)
        wrong = fmt::format("#{} of client {} went before its #{}", command, client, *queue->second.begin());
    passed_.erase(client);
    gone(client, command);
    for (const auto& [other, queue] : waiting_)
        if (other != client && !passed_[other].insert(client).second)
            wrong = fmt::format("client {} was served twice while #{} of client {} waited", client,
                                *queue.begin(), other);
    return wrong;
}

}  // namespace truth
