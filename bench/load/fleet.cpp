// SPDX-License-Identifier: Apache-2.0
#include "bench/load/fleet.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "asip/program/log.hpp"
#include "asip/program/options.hpp"

namespace asip::load {

namespace {

// So much at once before connections get their turn.
constexpr int kDueAtOnce = 500;
constexpr auto kValuesTick = std::chrono::milliseconds(10);
// What a board that joins publishes, and some more.
constexpr std::size_t kMessagesOfABoard = 16;
constexpr std::size_t kBytesOfABoard = 8 * 1024;
constexpr Duration kSharedSubscribeTimeout = std::chrono::minutes(5);

void add(Tally& tally, const mqtt::Counters& counted) {
    tally.received += counted.received;
    tally.published += counted.published;
    tally.dropped += counted.dropped_context;
    tally.refused += counted.refused;
    tally.denied += counted.rejected;
}

}  // namespace

Fleet::Fleet(boost::asio::io_context& io, FleetOptions options, const BoardKind& kind, Random random)
    : io_(io),
      options_(std::move(options)),
      kind_(kind),
      random_(std::move(random)),
      topics_(options_.topic_root),
      host_(program::host_name()),
      slots_(options_.boards),
      carriers_((options_.boards + options_.per_connection - 1) / options_.per_connection),
      timer_(io),
      values_timer_(io),
      end_timer_(io) {
    for (std::size_t board = 0; board < slots_.size(); ++board)
        absent_.push_back(static_cast<std::uint32_t>(board));
    auto& mqtt = options_.mqtt;
    mqtt.max_queued_messages =
        std::max(mqtt.max_queued_messages, kMessagesOfABoard * options_.per_connection);
    mqtt.max_queued_bytes = std::max(mqtt.max_queued_bytes, kBytesOfABoard * options_.per_connection);
    // The broker has as many more of them to read through.
    if (!own_connection()) mqtt.subscribe_timeout = kSharedSubscribeTimeout;
    if (options_.values_per_second > 0) schedule_values();
}

Fleet::~Fleet() = default;

std::string Fleet::name(std::size_t board) const {
    char digits[24];
    std::snprintf(digits, sizeof digits, "%06zu", board);
    return options_.prefix + digits;
}

std::optional<std::size_t> Fleet::number(std::string_view text) const {
    if (!text.starts_with(options_.prefix)) return std::nullopt;
    const auto digits = text.substr(options_.prefix.size());
    std::size_t board = 0;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), board);
    if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() || board >= slots_.size() ||
        name(board) != text)
        return std::nullopt;
    return board;
}

std::string_view Fleet::expected(std::size_t board) const {
    const Slot& slot = slots_[board];
    switch (slot.life) {
        case Life::kPresent:
            return slot.said ? "online" : "";
        case Life::kDead:
        case Life::kAway:
            return "lost";
        case Life::kHung:
            return Clock::now() - slot.began > std::chrono::seconds(options_.lease_seconds) ? "lost" : "";
        case Life::kLeft:
            return "offline";
        case Life::kNever:
            break;
    }
    return "";
}

std::optional<std::size_t> Fleet::pick(Verb verb) {
    auto& from = verb == Verb::kJoin ? absent_ : present_;
    if (from.empty()) return std::nullopt;
    const std::size_t board = from.front();
    from.pop_front();
    return board;
}

void Fleet::perform(const Plan::Due& due) {
    for (std::size_t i = 0; i < due.count && !ending_; ++i) {
        const auto board = pick(due.verb);
        if (!board) return;
        switch (due.verb) {
            case Verb::kJoin:
                ++tally_.joined;
                join(*board);
                break;
            case Verb::kDie:
                ++tally_.died;
                disconnect(*board, Life::kDead);
                break;
            case Verb::kFlap:
                ++tally_.flapped;
                disconnect(*board, Life::kAway);
                arm_at(*board, Clock::now() + due.down);
                break;
            case Verb::kHang:
                ++tally_.hung;
                hang(*board);
                break;
            case Verb::kLeave:
                ++tally_.left;
                leave(*board);
                break;
        }
    }
}

/// Into a life, and into the queue of those that may be picked next.
void Fleet::settle(std::size_t board, Life life) {
    Slot& slot = slots_[board];
    if (std::exchange(slot.acknowledged, false)) --announced_;
    slot.life = life;
    slot.began = Clock::now();
    slot.said.reset();
    slot.armed = Time::max();
    if (life == Life::kPresent) present_.push_back(static_cast<std::uint32_t>(board));
    if (life == Life::kDead || life == Life::kHung || life == Life::kLeft)
        absent_.push_back(static_cast<std::uint32_t>(board));
}

void Fleet::join(std::size_t board) {
    if (own_connection()) close(carriers_[carrier_of(board)]);
    const auto client = options_.mqtt.client_id + "-" + std::to_string(carrier_of(board));
    member::AnnouncerOptions announcer;
    announcer.board = name(board);
    announcer.lease_seconds = options_.lease_seconds;
    announcer.started_unix = options_.started_unix;
    announcer.on_shared_topic = options_.on_shared_topic;
    slots_[board].board = std::make_unique<SimulatedBoard>(
        topics_, kind_, std::move(announcer), kind_.describe(board, {ASIP_VERSION, host_, client}), random_);
    settle(board, Life::kPresent);
    attach(board);
}

void Fleet::attach(std::size_t board) {
    Carrier& carrier = carriers_[carrier_of(board)];
    if (!carrier.client) return open(carrier_of(board));
    if (!carrier.connected) return;
    with(board, [&](auto& one, Time now, auto& out) { one.on_connected(now, out, carrier.client->v5()); });
    if (carrier.client->subscribed())
        with(board, [](auto& one, Time now, auto& out) { one.on_subscribed(now, out); });
}

/// With the subscriptions of all its boards, also of those that join later: a board that joins does not wait
/// for others.
void Fleet::open(std::size_t number) {
    Carrier& carrier = carriers_[number];
    auto mqtt = options_.mqtt;
    mqtt.client_id += "-" + std::to_string(number);
    // Machines of a cluster have its list in different orders.
    const auto first = number % mqtt.brokers.size();
    std::rotate(mqtt.brokers.begin(), mqtt.brokers.begin() + static_cast<std::ptrdiff_t>(first),
                mqtt.brokers.end());
    if (own_connection()) mqtt.will = slots_[number].board->will();
    carrier.client = std::make_unique<mqtt::Client>(io_, std::move(mqtt), handlers(number));
    for_boards_of(number, [&](std::size_t board) {
        for (auto& [filter, how] : SimulatedBoard::subscriptions(topics_, name(board)))
            carrier.client->subscribe(std::move(filter), how);
    });
    carrier.client->start();
}

void Fleet::disconnect(std::size_t board, Life next) {
    Slot& slot = slots_[board];
    Carrier& carrier = carriers_[carrier_of(board)];
    if (own_connection())
        close(carrier);
    else if (carrier.client)
        carrier.client->publish(slot.board->will(), mqtt::Priority::kAnnouncement);
    slot.board->on_disconnected();
    settle(board, next);
    if (next != Life::kAway) slot.board.reset();
}

void Fleet::come_back(std::size_t board) {
    settle(board, Life::kPresent);
    attach(board);
    arm(board);
}

void Fleet::hang(std::size_t board) {
    settle(board, Life::kHung);
    slots_[board].board.reset();
}

void Fleet::leave(std::size_t board) {
    with(board, [](auto& one, Time now, auto& out) { one.goodbye(now, out); });
    settle(board, Life::kLeft);
    slots_[board].board.reset();
    stop_own_client(board);
}

void Fleet::close(Carrier& carrier) {
    if (!carrier.client) return;
    add(tally_, carrier.client->counters());
    carrier.client.reset();
    carrier.connected = false;
}

Tally Fleet::tally() const {
    Tally all = tally_;
    for (const auto& carrier : carriers_)
        if (carrier.client) add(all, carrier.client->counters());
    return all;
}

void Fleet::arm(std::size_t board) {
    const Slot& slot = slots_[board];
    if (!slot.board || slot.life != Life::kPresent) return;
    if (const auto deadline = slot.board->next_deadline()) arm_at(board, *deadline);
}

void Fleet::arm_at(std::size_t board, Time at) {
    if (slots_[board].armed <= at) return;
    slots_[board].armed = at;
    deadlines_.push({at, static_cast<std::uint32_t>(board)});
    arm_timer();
}

void Fleet::arm_timer() {
    if (deadlines_.empty() || deadlines_.top().at >= timer_at_) return;
    timer_at_ = deadlines_.top().at;
    timer_.expires_at(timer_at_);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (error) return;
        timer_at_ = Time::max();
        run_due();
    });
}

void Fleet::run_due() {
    const Time now = Clock::now();
    for (int i = 0; i < kDueAtOnce && !deadlines_.empty() && deadlines_.top().at <= now && !ending_; ++i) {
        const auto [at, board] = deadlines_.top();
        deadlines_.pop();
        Slot& slot = slots_[board];
        if (slot.armed != at) continue;
        slot.armed = Time::max();
        tally_.late.add(now - at);
        if (slot.life == Life::kAway)
            come_back(board);
        else if (slot.life == Life::kPresent)
            with(board, [](auto& one, Time when, auto& out) { one.tick(when, out); });
    }
    if (!ending_) arm_timer();
}

void Fleet::schedule_values() {
    values_since_ = Clock::now();
    values_timer_.expires_after(kValuesTick);
    values_timer_.async_wait([this](const boost::system::error_code& error) {
        if (error || ending_) return;
        const auto passed = std::chrono::duration<double>(Clock::now() - values_since_).count();
        values_due_ += passed * options_.values_per_second * static_cast<double>(present_.size());
        report_values();
        schedule_values();
    });
}

void Fleet::end(Duration limit, std::function<void()> done) {
    ending_ = true;
    ended_ = std::move(done);
    timer_.cancel();
    values_timer_.cancel();
    for (const std::size_t board : present_) {
        member::Announcements out;
        slots_[board].board->goodbye(Clock::now(), out);
        publish(board, out);
    }
    for (auto& carrier : carriers_) {
        if (!carrier.client) continue;
        ++stopping_;
        carrier.client->stop(limit, [this] {
            if (--stopping_ == 0) end_timer_.cancel();
        });
    }
    // Those that were stopping already end by themselves.
    end_timer_.expires_after(stopping_ == 0 ? Duration{} : limit);
    end_timer_.async_wait([this](const boost::system::error_code&) { ended_(); });
}

}  // namespace asip::load
