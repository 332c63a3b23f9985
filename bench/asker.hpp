// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "asip/bus/registry/query.hpp"
#include "asip/bus/request/requester.hpp"
#include "asip/mqtt/client.hpp"
#include "bench/figures.hpp"
#include "bench/retained_boards.hpp"

namespace asip::bench {

/// A client that asks a registry, over a connection of its own.
class Asker {
  public:
    Asker(boost::asio::io_context& io, const test::MosquittoBroker& broker, const std::string& name,
          std::string registry = "bench")
        : registry_(std::move(registry)),
          requester_(name, bus::ReplyTopics(topics_, "", name)),
          client_(io, options_for(broker), handlers()) {
        client_.subscribe(requester_.replies().filter(), {.qos = 1});
        client_.start();
        while (!client_.subscribed())
            io.run_one();
    }
    void ask(const bus::Query& query, std::function<void(const std::string& payload)> done) {
        mqtt::Message message{.topic = topics_.registry_query(registry_),
                              .payload = bus::encode(bus::RegistryRequest{query, {}, {}}),
                              .qos = 1};
        request_ = requester_.ask(message, client_.v5(),
                                  [done](const mqtt::Message& answer) { done(answer.payload); });
        client_.publish(std::move(message), mqtt::Priority::kReply);
    }

  private:
    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers result;
        result.on_message = [this](const mqtt::Message& message) { requester_.take(message); };
        return result;
    }

    bus::Topics topics_;
    std::string registry_;
    bus::Requester requester_;
    bus::Requester::Request request_;
    mqtt::Client client_;
};

/// Asks for one board after the other, 2 ms after each answer, and knows how long each answer took.
class SteadyAsker {
  public:
    SteadyAsker(boost::asio::io_context& io, const test::MosquittoBroker& broker, const std::string& name,
                std::uint32_t boards)
        : asker_(io, broker, name), pause_(io), boards_(boards) {}

    void begin() {
        samples_.clear();
        asking_ = true;
        ask();
    }
    std::size_t answers() const { return samples_.size(); }
    /// Milliseconds, since begin(). An answer that is under way is still awaited, and counted nowhere.
    std::vector<double> end() {
        asking_ = false;
        return std::move(samples_);
    }

  private:
    void ask() {
        bus::Query query;
        query.board = BoardTexts::name(next_ = (next_ * 7919 + 1) % boards_);
        const Time sent = Clock::now();
        asker_.ask(query, [this, sent](const std::string&) {
            if (!asking_) return;
            samples_.push_back(Milliseconds(Clock::now() - sent).count());
            pause_.expires_after(std::chrono::milliseconds(2));
            pause_.async_wait([this](const boost::system::error_code& error) {
                if (!error && asking_) ask();
            });
        });
    }

    Asker asker_;
    boost::asio::steady_timer pause_;
    std::uint32_t boards_;
    std::vector<double> samples_;
    std::uint32_t next_ = 0;
    bool asking_ = false;
};

}  // namespace asip::bench
