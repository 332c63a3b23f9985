// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/echo.hpp"

#include <cstdlib>
#include <utility>

#include "tests/cluster/commander.hpp"

namespace cluster {

namespace {

constexpr auto kBetweenMessages = std::chrono::milliseconds(100);

}  // namespace

Echo::Echo(boost::asio::io_context& io, asip::mqtt::Options options)
    : topic_("cluster-test/" + options.client_id),
      client_(io, std::move(options),
              {.on_connected = {},
               .on_disconnected = {},
               .on_connect_failed = {},
               .on_message =
                   [this](const asip::mqtt::Message& message) {
                       const bool counts = std::strtoll(message.payload.c_str(), nullptr, 10) >= since_;
                       if (counts && !heard_) heard_ = now();
                   },
               .on_published = {},
               .on_subscribe_refused = {},
               .on_debug = {},
               .on_subscribed = {}}),
      timer_(io) {
    client_.subscribe(topic_);
}

void Echo::start() {
    client_.start();
    send();
}

void Echo::look_anew() {
    since_ = now();
    heard_.reset();
}

void Echo::send() {
    timer_.expires_after(kBetweenMessages);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        if (client_.connected()) client_.publish({.topic = topic_, .payload = std::to_string(now())});
        send();
    });
}

}  // namespace cluster
