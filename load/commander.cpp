// SPDX-License-Identifier: Apache-2.0
#include "load/commander.hpp"

#include <algorithm>

namespace asip::load {
namespace {

constexpr auto kTick = std::chrono::milliseconds(5);
constexpr Duration kPatience = std::chrono::seconds(10);
// At boards in one turn, whether they can be commanded.
constexpr std::size_t kLooks = 5000;
constexpr std::size_t kMaxWaiting = 2000;

mqtt::Options commander_options(mqtt::Options options) {
    options.client_id += "-commands";
    return options;
}

}  // namespace

Commander::Commander(boost::asio::io_context& io, mqtt::Options options, const std::string& topic_root,
                     const BoardKind& kind, const Fleet& fleet, double per_second)
    : kind_(kind),
      fleet_(fleet),
      topics_(topic_root),
      per_second_(per_second),
      requester_(options.client_id + "-commands",
                 bus::ReplyTopics(topics_, options.user, options.client_id + "-commands")),
      client_(io, commander_options(options),
              {.on_connected = {},
               .on_disconnected = {},
               .on_connect_failed = {},
               .on_message = [this](const mqtt::Message& message) { requester_.take(message); },
               .on_published = {},
               .on_subscribe_refused = {},
               .on_debug = {},
               .on_subscribed = {}}),
      timer_(io) {
    client_.subscribe(requester_.replies().filter(), {.qos = 1});
}

void Commander::start() {
    client_.start();
    since_ = swept_ = Clock::now();
    schedule();
}

void Commander::schedule() {
    timer_.expires_after(kTick);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error || stopped_) return;
        const Time now = Clock::now();
        due_ += std::chrono::duration<double>(now - since_).count() * per_second_;
        since_ = now;
        if (client_.subscribed() && fleet_.announced() > 0) send_due();
        due_ = std::min(due_, per_second_);
        if (now - swept_ > std::chrono::seconds(1)) forget_overdue(now);
        schedule();
    });
}

void Commander::send_due() {
    for (std::size_t looked_at = 0; due_ >= 1 && looked_at < kLooks; ++looked_at) {
        const std::size_t number = next_++;
        const std::size_t board = number % fleet_.size();
        if (fleet_.expected(board) != "online") continue;
        const auto& service = kind_.services[(number / fleet_.size()) % kind_.services.size()];
        if (service.command.empty()) continue;
        due_ -= 1;
        if (waiting_.size() >= kMaxWaiting)
            ++tally_.left_out;
        else
            send(board, service);
    }
}

void Commander::send(std::size_t board, const BoardKind::Service& service) {
    mqtt::Message message;
    message.topic = topics_.service_in(fleet_.name(board), service.model->name);
    message.payload = service.command;
    message.qos = 1;
    const auto id = std::make_shared<std::string>();
    const Time now = Clock::now();
    auto request = requester_.ask(message, client_.v5(), [this, id, now](const mqtt::Message& answer) {
        const auto reply = bus::parse_reply(answer.payload);
        if (!reply || !waiting_.erase(*id)) return;
        ++(reply->succeeded() ? tally_.ok : tally_.refused);
        tally_.answered.add(Clock::now() - now);
    });
    *id = request.id();
    ++tally_.sent;
    waiting_.emplace(*id, Waiting{std::move(request), now});
    client_.publish(std::move(message), mqtt::Priority::kReply);
}

void Commander::forget_overdue(Time now) {
    swept_ = now;
    tally_.unanswered +=
        std::erase_if(waiting_, [&](const auto& one) { return now - one.second.sent > kPatience; });
}

CommandTally Commander::tally() const {
    auto result = tally_;
    result.unanswered += waiting_.size();
    return result;
}

}  // namespace asip::load
