// SPDX-License-Identifier: Apache-2.0
#include "bench/load/watchers.hpp"

#include <algorithm>

#include "asip/bus/topics.hpp"
#include "bench/load/watch.hpp"

namespace asip::load {
namespace {

// 1,000 a second: a broker's queue of new connections is short.
constexpr auto kStartTick = std::chrono::milliseconds(10);
constexpr std::size_t kStartsATick = 10;
constexpr Duration kLeaving = std::chrono::seconds(1);

}  // namespace

Watchers::Watchers(boost::asio::io_context& io, const mqtt::Options& options, const std::string& topic_root,
                   std::size_t number, const Fleet& fleet)
    : start_timer_(io),
      filter_(bus::Topics(topic_root).registry_events("+")),
      changes_(number, [&fleet](const bus::ChangeEvent& event) { return happened(fleet, event); }) {
    tally_.watchers = number;
    for (std::size_t watcher = 0; watcher < number; ++watcher) {
        auto own = options;
        own.client_id += "-watcher-" + std::to_string(watcher);
        clients_.push_back(std::make_unique<mqtt::Client>(io, std::move(own), handlers(watcher)));
        clients_.back()->subscribe(filter_);
    }
}

mqtt::Client::Handlers Watchers::handlers(std::size_t watcher) {
    mqtt::Client::Handlers result;
    result.on_message = [this, watcher](const mqtt::Message& message) {
        changes_.take(watcher, message.payload, Clock::now());
    };
    result.on_disconnected = [this, watcher](const mqtt::ConnectionFailure&) {
        ++tally_.connections_lost;
        changes_.forget(watcher);
    };
    result.on_connect_failed = [this](const mqtt::ConnectionFailure&) { ++tally_.attempts_failed; };
    return result;
}

void Watchers::start() {
    schedule_start();
}

void Watchers::schedule_start() {
    for (std::size_t i = 0; i < kStartsATick && started_ < clients_.size(); ++i)
        clients_[started_++]->start();
    if (started_ == clients_.size()) return;
    start_timer_.expires_after(kStartTick);
    start_timer_.async_wait([this](const boost::system::error_code& error) {
        if (!error) schedule_start();
    });
}

void Watchers::stop() {
    start_timer_.cancel();
    for (std::size_t watcher = 0; watcher < started_; ++watcher)
        clients_[watcher]->stop(kLeaving, [] {});
    started_ = clients_.size();
}

WatchersTally Watchers::tally() const {
    auto result = tally_;
    result.listening = static_cast<std::size_t>(
        std::count_if(clients_.begin(), clients_.end(), [](const auto& one) { return one->subscribed(); }));
    result.registries = changes_.seen();
    return result;
}

}  // namespace asip::load
