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

}  // namespace

// Time in which an agent, or the test, waited for a processor is added to what an answer may take.
std::int64_t Round::starved_ms(std::int64_t from, std::int64_t until) const {
    std::int64_t sum = 0;
    for (const auto& [begin, end] : starved_)
        sum += std::max<std::int64_t>(0, std::min(end, until) - std::max(begin, from));
    return sum;
}

bool Round::nobody_there(const Sent& sent) const {
    return std::any_of(outages_.begin(), outages_.end(), [&](const Downtime& outage) {
        return outage.board == sent.board && outage.until >= sent.at &&
               outage.from <= sent.at + kDeadlineMs + starved_ms(sent.at, outage.from);
    });
}

bool Round::starved(std::int64_t from, std::int64_t until) const {
    return std::any_of(starved_.begin(), starved_.end(),
                       [&](const auto& span) { return span.first <= until && span.second >= from; });
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
    const auto latest = sent.at + kDeadlineMs + kSlackMs;
    const auto to_board = sent.board->line().seen(sent.request);
    if (sent.answers > sent.copies) fail(sent, "answered twice");
    if (sent.duty != 0 && to_board.times > 1) fail(sent, "sent to the board twice");
    if (sent.duty != 0 && to_board.last_ms > latest && !starved(sent.at, to_board.last_ms))
        fail(sent, "sent to the board after its deadline");
    if (sent.answers == 0) {
        if (!nobody_there(sent)) return fail(sent, "never answered");
        ++counts_.nobody_there;
        return;
    }
    if (sent.answered > latest) {
        if (!starved(sent.at, sent.answered)) fail(sent, "answered late");
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
    const bool excused = !sent.board->has_checksums() &&
                         sent.board->line().damaged(sent.at - kDamageLastsMs, sent.answered + kStarvedMs);
    if (!excused) return fail(sent, sent.duty == 0 ? "a bad command was ok" : "ok and not executed");
    ++counts_.invisible;
}

}  // namespace truth
