// SPDX-License-Identifier: Apache-2.0
#include "bench/load/commander.hpp"

namespace asip::load {
namespace {

constexpr auto kTick = std::chrono::milliseconds(5);
// At boards in one turn, whether they can be commanded.
constexpr std::size_t kLooks = 5000;

}  // namespace

Commander::Commander(boost::asio::io_context& io, mqtt::Options options, const std::string& topic_root,
                     const BoardKind& kind, const Fleet& fleet, double per_second)
    : kind_(kind),
      fleet_(fleet),
      bus_(io, std::move(options), bus::Topics(topic_root), "-commands"),
      timer_(io),
      pace_(per_second) {}

void Commander::start() {
    bus_.client.start();
    pace_.begin(Clock::now());
    schedule();
}

void Commander::schedule() {
    timer_.expires_after(kTick);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error || stopped_) return;
        const Time now = Clock::now();
        pace_.pass(now);
        if (bus_.client.subscribed() && fleet_.announced() > 0) send_due();
        bus_.caller.tick(now);
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
        if (waiting_.size() >= Pending::kMax)
            ++tally_.left_out;
        else
            send(board, service);
    }
}

void Commander::send(std::size_t board, const BoardKind::Service& service) {
    const Time now = Clock::now();
    const auto number = tally_.sent++;
    waiting_[number] = bus_.caller.command(
        {.topic = bus_.caller.topics().service_in(fleet_.name(board), service.model->name),
         .payload = service.command,
         .deadline = Pending::kPatience},
        [this, number, now](const bus::Reply& reply) {
            const auto ended = waiting_.extract(number);
            if (reply.reason == bus::kTimeoutNoAnswer || reply.reason == bus::kTimeoutConnection) {
                ++tally_.unanswered;
                return;
            }
            ++(reply.succeeded() ? tally_.ok : tally_.refused);
            tally_.answered.add(Clock::now() - now);
        },
        now);
}

bool Commander::idle(Time now) {
    bus_.caller.tick(now);
    return waiting_.empty();
}

CommandTally Commander::tally() const {
    auto result = tally_;
    result.unanswered += waiting_.size();
    return result;
}

}  // namespace asip::load
