// SPDX-License-Identifier: Apache-2.0
// What happens in a round: commands, incidents, answers.
#include "tests/truth/live/round.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <stdexcept>

namespace truth {

using namespace std::chrono_literals;

namespace {

constexpr auto kBackOnline = 60s;
constexpr const char* kReplies = "asip/reply/truth";

}  // namespace

Round::Round(std::uint64_t seed, Counts& counts, const std::string& pico)
    : seed_(seed), counts_(counts), dice_(seed) {
    ++counts_.rounds;
    boards_.push_back(std::make_unique<LiveBoard>("ours", pico, pico.empty() ? "asip_uno" : "asip_pico", true,
                                                  broker_.url(), dice_.draw()));
    boards_.push_back(
        std::make_unique<LiveBoard>("plain", "", "asip_uno_04", false, broker_.url(), dice_.draw()));
    set_up();
}

void Round::connect() {
    replies_seen_ = 0;
    reconnects_seen_ = 0;
    for (Downtime& outage : outages_)
        outage.announced = 0;
    probe_ = std::make_unique<asip::test::BusProbe>(
        broker_.port(), std::vector<std::string>{kReplies, "asip/servicebus/+/$state"});
}

bool Round::online(const LiveBoard& board) const {
    return probe_->last("asip/servicebus/" + board.name() + "/$state") == "online";
}

void Round::set_up() {
    connect();
    for (auto& board : boards_) {
        if (!asip::test::wait_until([&] { return online(*board); }, 60s))
            throw std::runtime_error(board->name() + " is not online: " + board->agent().errors());
        for (const int pin : kPins)
            if (!probe_->request("asip/" + board->name() + "/in", fmt::format("I,P,{},5", pin)))
                throw std::runtime_error("no answer on a good line");
        for (int i = 0; i < 2; ++i)
            clients_.push_back(std::make_unique<TcpClient>(board->client_port()));
    }
}

std::size_t Round::announced(const LiveBoard& board) const {
    if (!probe_) return 0;
    const auto states = probe_->messages("asip/servicebus/" + board.name() + "/$state");
    return static_cast<std::size_t>(std::count_if(
        states.begin(), states.end(), [](const auto& state) { return state.payload == "online"; }));
}

// How long an agent takes to start depends on the machine.
void Round::end_outages() {
    for (Downtime& outage : outages_) {
        if (outage.over()) continue;
        if (online(*outage.board) && announced(*outage.board) > outage.announced)
            outage.until = now_ms();
        else if (passed_ms(outage.from) > std::chrono::milliseconds(kBackOnline).count())
            throw std::runtime_error(
                fmt::format("seed {}: {} does not come back", seed_, outage.board->name()));
    }
}

// Answers that come while the test itself has no connection are lost: the broker keeps none for a clean
// session.
void Round::watch_own_connection() {
    const auto now = now_ms();
    if (probe_->reconnects() != reconnects_seen_) {
        reconnects_seen_ = probe_->reconnects();
        ++counts_.own_reconnects;
        note(
            fmt::format("the test's own connection was lost (reason {}) and is back", probe_->last_reason()));
        for (const auto& board : boards_)
            outages_.push_back({board.get(), connected_, 0, now + kLagMs});
    }
    if (probe_->connected()) connected_ = now;
}

void Round::pump() {
    for (auto& client : clients_)
        client->pump();
    for (auto& board : boards_)
        board->observe();
    take_replies();
    for (std::size_t i = 0; i < later_.size();)
        if (later_[i].first <= now_ms()) {
            const auto action = later_[i].second;
            later_.erase(later_.begin() + static_cast<std::ptrdiff_t>(i));
            action();
        } else {
            ++i;
        }
    if (probe_) {
        end_outages();
        watch_own_connection();
    }
    asip::test::wait_until([] { return false; }, 3ms);
}

void Round::command_over_bus() {
    const auto index = dice_.below(boards_.size());
    Sent sent{.board = boards_[index].get(), .at = now_ms()};
    // What an agent cannot hear is not answered.
    if (!probe_ || (broker_restarted_ && !online(*sent.board))) return;
    std::string line;
    switch (dice_.below(6)) {
        case 0:
            line = "I,a,99,1";
            break;
        case 1:
            line = "I,d,2,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21";
            break;
        default:
            sent.pin = kPins[dice_.below(3)];
            sent.duty = duties_[index][static_cast<std::size_t>(sent.pin)] + 1;
            if (sent.duty > 254) return;
            duties_[index][static_cast<std::size_t>(sent.pin)] = sent.duty;
            line = fmt::format("I,a,{},{}", sent.pin, sent.duty);
    }
    asip::mqtt::Message message{.topic = "asip/" + sent.board->name() + "/in", .payload = line, .qos = 1};
    message.response_topic = kReplies;
    message.correlation = std::to_string(sent_.size());
    sent.request = line;
    sent_.push_back(std::move(sent));
    ++counts_.commands;
    probe_->publish(message);
    if (!dice_.chance(0.1)) return;
    ++counts_.repeated;
    ++sent_.back().copies;
    probe_->publish(message);
}

void Round::command_over_tcp() {
    const auto number = dice_.below(clients_.size());
    const auto index = number / 2;
    Sent sent{.board = boards_[index].get(), .tcp = true, .at = now_ms()};
    sent.pin = number % 2 == 0 ? kPins[3] : kPins[4 + dice_.below(2)];
    int& duty = duties_[index][static_cast<std::size_t>(sent.pin)];
    if (duty >= 254) return;
    sent.duty = ++duty;
    sent.request = fmt::format("I,a,{},{}", sent.pin, sent.duty);
    sent_.push_back(sent);
    ++counts_.commands;
    Sent& kept = sent_.back();
    const bool accepted =
        clients_[number]->submit(kept.request, 5s, [this, &kept](const asip::session::Finished& end) {
            using asip::session::Ending;
            const auto ending = end.ending;
            const bool ok = ending == Ending::kExecuted;
            answered(kept,
                     ok                              ? "ok"
                     : ending == Ending::kBoardError ? "error"
                     : ending == Ending::kNotSent    ? "refused"
                                                     : "timeout",
                     asip::session::to_string(ending));
        });
    if (!accepted) answered(kept, "refused", "not submitted");
}

void Round::take_replies() {
    if (!probe_) return;
    const auto replies = probe_->messages(kReplies);
    for (; replies_seen_ < replies.size(); ++replies_seen_) {
        const auto& reply = replies[replies_seen_];
        const auto number = std::strtoul(reply.correlation.c_str(), nullptr, 10);
        if (number >= sent_.size() || sent_[number].tcp) continue;
        for (const char* status : {"ok", "error", "timeout", "refused"})
            if (reply.payload.find(fmt::format(R"("status":"{}")", status)) != std::string::npos)
                answered(sent_[number], status, reply.payload);
    }
}

void Round::answered(Sent& sent, std::string status, std::string answer) {
    // QoS 1: what the broker had passed on but not acknowledged when it died is sent again.
    const bool redelivered =
        sent.answers > 0 && !sent.tcp && answer == sent.answer && broker_died_ + kSlackMs >= sent.answered;
    if (redelivered) {
        ++counts_.redelivered;
        return;
    }
    ++sent.answers;
    sent.answered = now_ms();
    sent.status = std::move(status);
    sent.answer = std::move(answer);
}

void Round::incident() {
    auto& board = *boards_[dice_.below(boards_.size())];
    const auto lasts = dice_.between(50, 1200);
    ++counts_.incidents;
    const auto kind = dice_.below(12);
    note(fmt::format("incident {} of {} for {} ms", kind, board.name(), lasts));
    switch (kind) {
        case 0:
        case 1:
        case 9:
        case 10:
        case 11:
            board.line().damage(dice_.chance(0.5) ? 1.0 / 200 : 1.0 / 40);
            later_.emplace_back(now_ms() + lasts, [&board] { board.line().damage(0); });
            return;
        case 2:
            board.line().stall(true);
            later_.emplace_back(now_ms() + lasts, [&board] { board.line().stall(false); });
            return;
        case 3:
            return board.reset();
        case 4:
            board.line().unplug();
            board.reset();
            later_.emplace_back(now_ms() + lasts, [&board] { board.line().plug(); });
            return;
        case 5:
            begin_outage(board);
            board.agent().signal(SIGKILL);
            later_.emplace_back(now_ms() + lasts, [&board] { board.start_agent(); });
            return;
        case 6:
            board.agent().signal(SIGSTOP);
            later_.emplace_back(now_ms() + lasts, [&board] { board.agent().signal(SIGCONT); });
            return;
        case 7:
            broker_.freeze();
            later_.emplace_back(now_ms() + lasts, [this] { broker_.thaw(); });
            return;
        default:
            for (const auto& each : boards_)
                begin_outage(*each);
            probe_.reset();
            broker_.kill();
            broker_restarted_ = true;
            broker_died_ = now_ms();
            later_.emplace_back(now_ms() + lasts, [this] {
                broker_.start();
                connect();
            });
    }
}

void Round::run(std::int64_t active_ms) {
    const auto until = now_ms() + active_ms;
    auto next_command = now_ms();
    auto next_incident = now_ms() + 500;
    while (now_ms() < until) {
        pump();
        if (now_ms() >= next_command) {
            dice_.chance(0.5) ? command_over_bus() : command_over_tcp();
            next_command = now_ms() + dice_.between(1, 40);
        }
        if (now_ms() >= next_incident && later_.empty()) {
            incident();
            next_incident = now_ms() + dice_.between(100, 2500);
        }
    }
    drain();
    check();
}

void Round::drain() {
    const auto began = now_ms();
    const auto waiting = [&] {
        return std::any_of(sent_.begin(), sent_.end(), [](const Sent& sent) { return sent.answers == 0; });
    };
    while (!later_.empty() || (passed_ms(began) < kDeadlineMs + kSlackMs && waiting()))
        pump();
    for (const auto end = now_ms() + 300; now_ms() < end;)
        pump();
}

}  // namespace truth
