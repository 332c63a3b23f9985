// SPDX-License-Identifier: Apache-2.0
#include "bench/load/queries.hpp"

#include <utility>

#include "asip/bus/registry/answer.hpp"

namespace asip::load {
namespace {

constexpr auto kAskTick = std::chrono::milliseconds(5);
// A registry that does not list a board which was announced so long ago is wrong.
constexpr Duration kSurelyKnown = std::chrono::seconds(10);

std::vector<std::string> models_of(const BoardKind& kind) {
    std::vector<std::string> models;
    for (const auto& service : kind.services)
        models.push_back(service.model->name);
    return models;
}

}  // namespace

Queries::Queries(boost::asio::io_context& io, const mqtt::Options& options, const std::string& topic_root,
                 const BoardKind& kind, const Fleet& fleet, double per_second)
    : fleet_(fleet),
      topics_(topic_root),
      questions_(models_of(kind), fleet.size()),
      timer_(io),
      pace_(per_second) {
    for (std::size_t i = 0; i < kConnections; ++i)
        connections_.push_back(
            std::make_unique<Calling>(io, options, topics_, "-queries-" + std::to_string(i)));
}

void Queries::start() {
    for (auto& connection : connections_)
        connection->client.start();
    swept_ = Clock::now();
    pace_.begin(swept_);
    schedule();
}

void Queries::schedule() {
    timer_.expires_after(kAskTick);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error || stopped_) return;
        const Time now = Clock::now();
        pace_.pass(now);
        if (fleet_.announced() > 0) ask_due();
        if (now - swept_ > std::chrono::seconds(1)) forget_overdue(now);
        schedule();
    });
}

void Queries::ask_due() {
    for (std::size_t without = 0; pace_.due() && without < connections_.size();) {
        auto& connection = *connections_[next_++ % connections_.size()];
        if (!connection.client.subscribed()) {
            ++without;
            continue;
        }
        without = 0;
        pace_.done();
        if (pending_.full())
            ++tally_.left_out;
        else
            ask(connection);
    }
}

void Queries::ask(Calling& connection) {
    const auto asked = std::make_shared<Asked>();
    asked->sent = Clock::now();
    asked->question = questions_.next([this](std::size_t board) { return fleet_.name(board); });
    const auto& question = asked->question;
    asked->there_since = there_since(question, asked->sent);
    mqtt::Message message;
    message.topic =
        question.registry.empty() ? topics_.any_registry_query() : topics_.registry_query(question.registry);
    message.payload = bus::encode(bus::RegistryRequest{question.query, {}, {}});
    message.qos = 1;
    message.expire_after(Pending::kPatience);
    auto request = connection.caller.ask(
        std::move(message),
        [this, asked](const mqtt::Message& answer) {
            if (pending_.end(asked->id)) answered(*asked, answer.payload);
        },
        asked->sent);
    asked->id = request.id();
    ++tally_[question.kind].asked;
    if (asked->id.empty()) {
        ++tally_[question.kind].unanswered;
        return;
    }
    pending_.add(std::move(request), asked->sent, static_cast<std::size_t>(question.kind));
}

/// Since when the board of a question has been there, if that is so long that each registry knows it.
std::optional<Time> Queries::there_since(const Question& question, Time now) const {
    if (!question.board || fleet_.expected(*question.board) != "online") return std::nullopt;
    const Time since = fleet_.since(*question.board);
    return now - since > kSurelyKnown ? std::optional(since) : std::nullopt;
}

void Queries::answered(const Asked& asked, const std::string& payload) {
    const Time now = Clock::now();
    auto& tally = tally_[asked.question.kind];
    ++tally.answered;
    tally.took.add(now - asked.sent);
    const auto answer = bus::parse_answer(payload);
    if (!answer) {
        ++tally.wrong;
        return;
    }
    if (!answer->refused.empty()) {
        ++tally.refused;
        return;
    }
    questions_.answered(asked.question, *answer);
    const bool still_there = asked.there_since && asked.there_since == there_since(asked.question, now);
    if (still_there && !answer->settling && !holds(*answer, asked.question.query.board)) ++tally.wrong;
}

void Queries::forget_overdue(Time now) {
    swept_ = now;
    for (const auto kind : pending_.forget_overdue(now))
        ++tally_.kinds[kind].unanswered;
}

bool Queries::idle(Time now) {
    forget_overdue(now);
    return pending_.empty();
}

QueryTally Queries::tally() const {
    auto result = tally_;
    for (const auto kind : pending_.kinds())
        ++result.kinds[kind].unanswered;
    return result;
}

}  // namespace asip::load
