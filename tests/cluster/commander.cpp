// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/commander.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/request/reply.hpp"

namespace cluster {

using asip::bus::Reply;

namespace {

constexpr Millis kOnItsWay = 1000;  // an answer at the end of the deadline

Outcome outcome_of(Reply::Status status) {
    switch (status) {
        case Reply::Status::kOk:
            return Outcome::kOk;
        case Reply::Status::kError:
            return Outcome::kError;
        case Reply::Status::kRefused:
            return Outcome::kRefused;
        case Reply::Status::kTimeout:
            break;
    }
    return Outcome::kTimeout;
}

}  // namespace

Millis now() {
    return std::chrono::duration_cast<std::chrono::milliseconds>(asip::Clock::now() - time_of(0)).count();
}

Commander::Commander(boost::asio::io_context& io, asip::mqtt::Options options, History& history,
                     const Load& load)
    : history_(history),
      requester_(options.client_id, asip::bus::ReplyTopics(topics_, options.user, options.client_id)),
      client_(io, options,
              {.on_connected = {},
               .on_disconnected = {},
               .on_connect_failed = {},
               .on_message = [this](const asip::mqtt::Message& message) { requester_.take(message); },
               .on_published = {},
               .on_subscribe_refused = {},
               .on_debug = {},
               .on_subscribed = {}}),
      timer_(io),
      pause_(static_cast<std::int64_t>(1e6 / load.per_second)),
      load_(load),
      next_(load.first) {
    client_.subscribe(requester_.replies().filter(), {.qos = 1});
}

void Commander::start() {
    client_.start();
    timer_.expires_after(pause_);
    send();
}

void Commander::send() {
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        timer_.expires_at(timer_.expiry() + pause_);
        std::erase_if(waiting_, [](const auto& each) { return now() > each.second.until; });
        const std::size_t token = history_.commands.size();
        const std::size_t board = next_++ % load_.boards;
        history_.commands.push_back({.board = board, .sent = now()});
        asip::mqtt::Message message{.topic = topics_.board_in(history_.boards[board]),
                                    .payload = nlohmann::json{{"raw", load_.request(board, token)},
                                                              {"deadline_ms", history_.deadline}}
                                                   .dump(),
                                    .qos = load_.qos,
                                    .expiry_seconds = static_cast<std::uint32_t>(history_.deadline / 1000)};
        auto request =
            requester_.ask(message, client_.v5(),
                           [this, token](const asip::mqtt::Message& answer) { answered(token, answer); });
        waiting_.emplace(token, Waiting{std::move(request), now() + history_.deadline + kOnItsWay});
        client_.publish(std::move(message), asip::mqtt::Priority::kReply);
        send();
    });
}

// Kept until its time is over, so that a second answer is seen.
void Commander::answered(std::size_t token, const asip::mqtt::Message& message) {
    const auto reply = asip::bus::parse_reply(message.payload);
    if (!reply) return;
    Command& command = history_.commands[token];
    const auto outcome = outcome_of(reply->status);
    if (command.answered) {
        command.differing = command.differing || outcome != command.outcome;
        return;
    }
    command.answered = now();
    command.outcome = outcome;
    command.reason = reply->reason;
}

}  // namespace cluster
