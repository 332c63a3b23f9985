// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <cstdint>

#include "asip/mqtt/client.hpp"
#include "bench/catalogue_load.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::bench {

inline mqtt::Options options_for(const test::MosquittoBroker& broker, std::size_t messages = 400'000) {
    mqtt::Options options;
    options.brokers = {*mqtt::parse_broker(broker.address())};
    options.max_queued_messages = messages;
    options.max_queued_bytes = 1u << 30;
    options.max_packet_bytes = 0;
    return options;
}

inline mqtt::Message description(std::uint32_t board, std::uint64_t seq,
                                 const BoardTexts& texts = BoardTexts()) {
    return mqtt::Message{.topic = "asip/servicebus/" + BoardTexts::name(board) + "/$description",
                         .payload = texts.description(board, seq, 3600),
                         .qos = 1,
                         .retain = true,
                         .expiry_seconds = 3600};
}

/// So many boards, each by its retained description; returns when the broker has them all.
inline void retain_boards(const test::MosquittoBroker& broker, std::uint32_t boards,
                          const BoardTexts& texts = BoardTexts()) {
    boost::asio::io_context io;
    std::uint32_t sent = 0;
    std::uint32_t acknowledged = 0;
    mqtt::Client* client = nullptr;
    mqtt::Client::Handlers handlers;
    handlers.on_connected = [&](const mqtt::Connected&) {
        while (sent < boards && sent < 1000)
            client->publish(description(sent++, 1, texts), mqtt::Priority::kAnnouncement);
    };
    handlers.on_published = [&](const std::string&) {
        if (++acknowledged == boards) return io.stop();
        if (sent < boards) client->publish(description(sent++, 1, texts), mqtt::Priority::kAnnouncement);
    };
    mqtt::Client loader(io, options_for(broker), handlers);
    client = &loader;
    loader.start();
    io.run();
}

}  // namespace asip::bench
