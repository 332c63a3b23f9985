// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/router.hpp"

#include <mosquitto.h>

#include <algorithm>
#include <vector>

namespace asip::mqtt {

struct Router::State {
    struct Entry {
        std::string filter;
        OnMessage on_message;
    };

    void ended(const std::string& filter) {
        std::erase_if(entries, [](const auto& entry) { return entry.expired(); });
        const bool used = std::any_of(entries.begin(), entries.end(), [&](const auto& weak) {
            const auto entry = weak.lock();
            return entry && entry->filter == filter;
        });
        if (!used && on_unused) on_unused(filter);
    }

    OnUnused on_unused;
    std::vector<std::weak_ptr<Entry>> entries;
};

Router::Router(OnUnused on_unused) : state_(std::make_shared<State>()) {
    state_->on_unused = std::move(on_unused);
}

Router::Subscription Router::add(std::string filter, OnMessage on_message) {
    const std::shared_ptr<State::Entry> entry(new State::Entry{std::move(filter), std::move(on_message)},
                                              [state = std::weak_ptr<State>(state_)](State::Entry* ended) {
                                                  const auto name = std::move(ended->filter);
                                                  delete ended;
                                                  if (const auto router = state.lock()) router->ended(name);
                                              });
    state_->entries.push_back(entry);
    return Subscription(entry);
}

void Router::dispatch(const Message& message) {
    const auto state = state_;
    const auto present = state->entries;  // callbacks add and end entries
    for (const auto& weak : present) {
        const auto entry = weak.lock();
        if (entry && topic_matches(entry->filter, message.topic)) entry->on_message(message);
    }
}

bool topic_matches(const std::string& filter, const std::string& topic) {
    bool matches = false;
    return mosquitto_topic_matches_sub2(filter.data(), filter.size(), topic.data(), topic.size(), &matches) ==
               MOSQ_ERR_SUCCESS &&
           matches;
}

}  // namespace asip::mqtt
