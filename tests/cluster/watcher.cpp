// SPDX-License-Identifier: Apache-2.0
#include "tests/cluster/watcher.hpp"

#include <fmt/format.h>

#include <utility>

#include "tests/cluster/commander.hpp"
#include "tests/cluster/judge.hpp"

namespace cluster {

namespace {

constexpr auto kBetweenQuestions = std::chrono::milliseconds(200);
constexpr Millis kNoAnswer = 1000;
constexpr Millis kOld = 1500;

}  // namespace

Watcher::Watcher(boost::asio::io_context& io, asip::mqtt::Options options, std::string registry,
                 const Truth& truth, History& history)
    : registry_(std::move(registry)),
      truth_(truth),
      history_(history),
      requester_(options.client_id, asip::bus::ReplyTopics(topics_, options.user, options.client_id)),
      client_(io, options,
              {.on_connected =
                   [this](const asip::mqtt::Connected&) {
                       joined_ = false;
                       view_.restart();
                   },
               .on_disconnected = [this](const asip::mqtt::ConnectionFailure&) { joined_ = false; },
               .on_connect_failed = {},
               .on_message =
                   [this](const asip::mqtt::Message& message) {
                       if (requester_.take(message)) return;
                       if (const auto change = asip::bus::parse_change_event(message.payload)) event(*change);
                   },
               .on_published = {},
               .on_subscribe_refused = {},
               .on_debug = {},
               .on_subscribed = {}}),
      timer_(io) {
    client_.subscribe(requester_.replies().filter(), {.qos = 1});
    client_.subscribe(topics_.registry_events(registry_), {.qos = 1});
}

void Watcher::start() {
    client_.start();
    ask();
}

std::optional<Millis> Watcher::right_since() const {
    return now() - seen_ > kOld ? std::nullopt : right_since_;
}

void Watcher::ask() {
    timer_.expires_after(kBetweenQuestions);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        const bool waits = !request_.id().empty() && now() - asked_ < kNoAnswer;
        if (!request_.id().empty() && !waits) view_.restart();
        if (!waits && client_.subscribed()) {
            asip::bus::Query query;
            query.limit = asip::bus::Query::kMaxPage;
            asip::mqtt::Message message{.topic = topics_.registry_query(registry_),
                                        .payload = asip::bus::encode(asip::bus::RegistryRequest{
                                            view_.next_query().value_or(query), {}, {}}),
                                        .qos = 1,
                                        .expiry_seconds = 1};
            request_ = requester_.ask(message, client_.v5(), [this](const asip::mqtt::Message& payload) {
                if (const auto answer = asip::bus::parse_answer(payload.payload)) answered(*answer);
            });
            asked_ = now();
            client_.publish(std::move(message), asip::mqtt::Priority::kReply);
        }
        ask();
    });
}

void Watcher::answered(const asip::bus::Answer& answer) {
    request_.reset();
    if (!answer.refused.empty()) return;
    if (view_.needs_snapshot() && !view_.page(answer)) view_.restart();
    if (!answer.settling && answer.cursor.empty()) look(answer.boards);
}

void Watcher::event(const asip::bus::ChangeEvent& event) {
    const bool reset = event.kind == asip::bus::ChangeEvent::Kind::kReset;
    if (joined_ && epoch_ == event.epoch && !reset && event.seq != seq_ + 1 && event.seq != seq_)
        history_.gaps.push_back({registry_, seq_, event.seq, came_, now()});
    joined_ = true;
    came_ = now();
    epoch_ = event.epoch;
    seq_ = event.seq;
    view_.event(event);
}

void Watcher::compare(const std::map<std::string, std::string>& states, Difference& difference) const {
    for (const auto& [board, state] : states)
        if (state == "online" && !truth_.online.contains(board)) difference.ghosts.push_back(board);
    for (const auto& board : truth_.online) {
        const auto found = states.find(board);
        if (found == states.end() || found->second != "online") difference.lost.push_back(board);
    }
}

void Watcher::look(const std::vector<asip::bus::BoardItem>& boards) {
    std::map<std::string, std::string> asked, copied;
    for (const auto& board : boards)
        asked[board.board] = board.state;
    for (const auto& [name, board] : view_.boards())
        copied[name] = board.state;
    difference_ = {};
    compare(asked, difference_);
    if (difference_.none()) compare(copied, difference_);
    const bool right = difference_.none() && view_.complete();
    const bool fresh = now() - seen_ <= kOld;
    seen_ = now();
    note(!difference_.none() ? text_of(difference_) : right ? " right" : " right, but the copy has a gap");
    if (!right)
        right_since_.reset();
    else if (!right_since_ || !fresh)
        right_since_ = seen_;
}

void Watcher::note(std::string what) {
    if (what == noted_) return;
    log_ += fmt::format("{:8.3f} s:{}\n", static_cast<double>(seen_) / 1000, what);
    noted_ = std::move(what);
}

}  // namespace cluster
