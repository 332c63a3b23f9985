// SPDX-License-Identifier: Apache-2.0
#include "bench/load/commander.hpp"

namespace asip::load {
namespace {

constexpr auto kTick = std::chrono::milliseconds(5);
// At boards in one turn, whether they can be commanded.
constexpr std::size_t kLooks = 5000;

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
      timer_(io),
      pace_(per_second) {
    client_.subscribe(requester_.replies().filter(), {.qos = 1});
}

void Commander::start() {
    client_.start();
    swept_ = Clock::now();
    pace_.begin(swept_);
    schedule();
}

void Commander::schedule() {
    timer_.expires_after(kTick);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error || stopped_) return;
        const Time now = Clock::now();
        pace_.pass(now);
        if (client_.subscribed() && fleet_.announced() > 0) send_due();
        if (now - swept_ > std::chrono::seconds(1)) forget_overdue(now);
        schedule();
    });
}

void Commander::send_due() {
    for (std::size_t looked_at = 0; pace_.due() && looked_at < kLooks; ++looked_at) {
        const std::size_t number = next_++;
        const std::size_t board = number % fleet_.size();
        if (fleet_.expected(board) != "online") continue;
        const auto& service = kind_.services[(number / fleet_.size()) % kind_.services.size()];
        if (service.command.empty()) continue;
        pace_.done();
        if (pending_.full())
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
        if (!reply || !pending_.end(*id)) return;
        ++(reply->succeeded() ? tally_.ok : tally_.refused);
        tally_.answered.add(Clock::now() - now);
    });
    *id = request.id();
    ++tally_.sent;
    pending_.add(std::move(request), now);
    client_.publish(std::move(message), mqtt::Priority::kReply);
}

void Commander::forget_overdue(Time now) {
    swept_ = now;
    tally_.unanswered += pending_.forget_overdue(now).size();
}

bool Commander::idle(Time now) {
    forget_overdue(now);
    return pending_.empty();
}

CommandTally Commander::tally() const {
    auto result = tally_;
    result.unanswered += pending_.kinds().size();
    return result;
}

}  // namespace asip::load
