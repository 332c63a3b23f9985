// SPDX-License-Identifier: Apache-2.0
// Whether the answers of a round are true.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "tests/truth/live/round.hpp"

namespace truth {

namespace {

// What was damaged may have been held by a stalled line, or by a fence that was waited for.
constexpr std::int64_t kDamageLastsMs = 3000;
constexpr std::int64_t kLookBackMs = 3 * kDamageLastsMs;

}  // namespace

std::int64_t Round::passed_ms(std::int64_t from, std::int64_t until) const {
    const auto time = [](std::int64_t ms) { return asip::Time{} + std::chrono::milliseconds(ms); };
    const auto passed = machine_.passed(time(from), time(until));
    return std::chrono::duration_cast<std::chrono::milliseconds>(passed).count();
}

bool Round::nobody_there(const Sent& sent) const {
    return std::any_of(outages_.begin(), outages_.end(), [&](const Downtime& outage) {
        return outage.board == sent.board && outage.until >= sent.at &&
               passed_ms(sent.at, outage.from) <= kDeadlineMs;
    });
}

bool Round::executed(const Sent& sent) const {
    return sent.board->executed_at(sent.pin, sent.duty) != 0;
}

void Round::fail(const Sent& sent, const std::string& what) {
    ++counts_.failures;
    fmt::print("FAILED (seed {}): {} pin {} duty {} over {}: {}; answer {}\n", seed_, sent.board->name(),
               sent.pin, sent.duty, sent.tcp ? "TCP" : "MQTT", what, sent.answer);
    story_.emplace_back(sent.at, fmt::format("sent to {}: {}: {}", sent.board->name(), sent.request, what));
}

// What led to wrong answers: a round does not happen again in the same way.
void Round::tell() const {
    auto story = story_;
    if (probe_)
        for (const auto& board : boards_)
            story.emplace_back(
                now_ms(),
                fmt::format(
                    "{} is {} at last", board->name(),
                    probe_->last("asip/servicebus/" + board->name() + "/$state").value_or("unknown")));
    std::stable_sort(story.begin(), story.end(),
                     [](const auto& one, const auto& other) { return one.first < other.first; });
    for (const auto& [at, what] : story) {
        const auto then = std::chrono::system_clock::now() - std::chrono::milliseconds(now_ms() - at);
        fmt::print("  {:%T} {}\n", std::chrono::floor<std::chrono::milliseconds>(then), what);
    }
    for (const auto& board : boards_)
        fmt::print("-- agent of {}:\n{}\n", board->name(), board->agent().errors());
}

void Round::check() {
    // What the simulators report may come later than the answers.
    asip::test::wait_until([&] {
        for (const auto& board : boards_)
            board->observe();
        return std::all_of(sent_.begin(), sent_.end(),
                           [&](const Sent& sent) { return sent.status != "ok" || executed(sent); });
    });
    for (const auto& board : boards_)
        counts_.faults += board->line().faults();
    const auto before = counts_.failures;
    for (const Sent& sent : sent_)
        check(sent);
    if (counts_.failures != before) tell();
}

void Round::check(const Sent& sent) {
    constexpr auto kLatestMs = kDeadlineMs + kSlackMs;
    const auto to_board = sent.board->line().seen(sent.request);
    if (sent.answers > sent.copies) fail(sent, "answered twice");
    if (sent.duty != 0 && to_board.times > 1) fail(sent, "sent to the board twice");
    if (sent.duty != 0 && passed_ms(sent.at, to_board.last_ms) > kLatestMs)
        fail(sent, "sent to the board after its deadline");
    if (sent.answers == 0) {
        if (!nobody_there(sent)) return fail(sent, "never answered");
        ++counts_.nobody_there;
        return;
    }
    if (sent.answered > sent.at + kLatestMs) {
        if (passed_ms(sent.at, sent.answered) > kLatestMs) fail(sent, "answered late");
        ++counts_.starved;
    }
    if (sent.status == "refused") ++counts_.refused;
    if (sent.status == "error") ++counts_.error;
    if (sent.status == "timeout")
        ++(sent.answer.find("doubt") != std::string::npos ? counts_.doubt : counts_.timeout);
    if (sent.status == "refused" && sent.duty != 0 && to_board.times != 0)
        fail(sent, "refused and sent to the board");
    if (sent.status != "ok") return;
    ++counts_.ok;
    if (sent.duty != 0 && executed(sent)) return;
    // Both are times of the machine.
    const auto lacked = kLookBackMs - passed_ms(sent.at - kLookBackMs, sent.at);
    const auto lag = kLagMs + sent.answered - sent.at - passed_ms(sent.at, sent.answered);
    const bool excused = !sent.board->has_checksums() &&
                         sent.board->line().damaged(sent.at - kDamageLastsMs - lacked, sent.answered + lag);
    if (!excused) return fail(sent, sent.duty == 0 ? "a bad command was ok" : "ok and not executed");
    ++counts_.invisible;
}

}  // namespace truth
