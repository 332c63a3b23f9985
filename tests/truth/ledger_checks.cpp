// SPDX-License-Identifier: Apache-2.0
// Whether an answer is true: compared with what the board did.
#include <fmt/format.h>

#include <algorithm>

#include "asip/protocol/body.hpp"
#include "asip/protocol/message.hpp"
#include "tests/truth/explanations.hpp"
#include "tests/truth/ledger.hpp"
#include "tests/truth/lines.hpp"

namespace truth {

namespace {

// On a calm line a board executes within this what was sent, its loop as slow as it may be.
constexpr Micros kCalmDelay = 150 * kMillisecond;
// And it answers within this, be its answers long; it reads nothing while it writes them.
constexpr Micros kCalmAnswer = 800 * kMillisecond;
constexpr Micros kPeriodChanges = 1200 * kMillisecond;

bool has(const std::vector<Effect>& effects, const std::optional<Effect>& wanted) {
    return wanted && std::find(effects.begin(), effects.end(), *wanted) != effects.end();
}

// The board may refuse two parts of a request that paused.
bool has_error(std::string_view reply, int code) {
    for (auto begin = reply.find('~'); begin != reply.npos; begin = reply.find('~', begin + 1)) {
        const auto message =
            asip::protocol::parse_line(reply.substr(begin, reply.find('}', begin) + 1 - begin));
        const auto* const error = std::get_if<asip::protocol::ErrorReply>(&message);
        if (error && error->code == code) return true;
    }
    return false;
}

// The same numbers: the comma before a brace may be missing.
bool same_value(const std::string& a, const std::string& b) {
    if (a == b) return true;
    const auto first = asip::protocol::parse_line(a), second = asip::protocol::parse_line(b);
    const auto* const one = std::get_if<asip::protocol::Event>(&first);
    const auto* const other = std::get_if<asip::protocol::Event>(&second);
    if (one == nullptr || other == nullptr || one->service != other->service || one->tag != other->tag)
        return false;
    const auto body = asip::protocol::parse_body(one->body),
               other_body = asip::protocol::parse_body(other->body);
    return body && other_body && body->items == other_body->items;
}

}  // namespace

void Ledger::check_late(const BoardRead& read) {
    if (read.sources.size() != 1 || damaged_to_board_[read.sources[0]]) return;
    const auto known = by_line_.find(read.text);
    if (known == by_line_.end()) return;
    for (const std::size_t index : known->second) {
        const Entry& entry = entries_[index];
        if (entry.wire_line != read.sources[0]) continue;
        if (entry.state == State::kWaiting) fail(describe(entry) + " was executed before it was sent");
        if (calm_ && read.at > entry.deadline + kCalmAnswer)
            fail(describe(entry) + " was executed after its deadline on a calm line");
    }
}

// When it was sent, or another that looks the same and was under way at the same time.
Micros Ledger::sent(const Entry& entry) const {
    Micros earliest = entry.sent;
    for (const std::size_t index : by_line_.at(entry.command.line)) {
        const Entry& twin = entries_[index];
        if (twin.sent < earliest && twin.ended >= entry.sent) earliest = twin.sent;
    }
    return earliest;
}

void Ledger::check_calm(const Entry& entry, const Answer& answer, Micros now) {
    const bool hurried = entry.sent == kNever || now - entry.sent < kCalmAnswer;
    // The error could be that of both lines read as one.
    const bool behind_error =
        !entry.checksum && std::any_of(executions_.begin(), executions_.end(), [&](const auto& one) {
            return (one.error == 2 || one.error == 11) && one.read.at >= entry.sent - kCalmDelay;
        });
    // It ends what was being measured; and while the period changes, only a value behind the fence counts.
    const bool excused = std::any_of(executions_.begin(), executions_.end(), [&](const Execution& one) {
        return (one.read.text == "#,R" && one.read.at >= entry.sent) ||
               (is_period(one.read.text) && (one.error >= 0 || one.read.at >= entry.sent - kPeriodChanges));
    });
    // One that ended without its value, just before it, may have got what was measured for both.
    const auto& twins = by_line_[entry.command.line];
    const bool after_another = std::any_of(twins.begin(), twins.end(), [&](std::size_t twin) {
        return entries_[twin].without_value && entries_[twin].ended <= entry.sent &&
               entries_[twin].ended >= entry.sent - kCalmDelay;
    });
    bool doubtful = answer.outcome == Outcome::kDoubt && entry.command.prove && !behind_error;
    if (doubtful && ambiguous(entry)) {
        ++counts.equal_digests;
        doubtful = false;
    }
    const bool unsure = answer.outcome == Outcome::kTimeout ||
                        (answer.outcome == Outcome::kNoValue && !excused && !after_another);
    if (doubtful || (unsure && !hurried && !may_be_own(entry.command.line)))
        fail(fmt::format("{} was answered `{}` on a calm line", describe(entry), to_string(answer.outcome)));
}

// Whether the digest of its batch does not tell which requests of the batch failed.
bool Ledger::ambiguous(const Entry& entry) const {
    const auto is_fence = [](const Execution& one) { return one.read.text.starts_with("#,V,"); };
    const auto its = std::find_if(executions_.begin(), executions_.end(), [&](const Execution& one) {
        return one.read.sources == std::vector{entry.wire_line};
    });
    const auto before = std::find_if(std::make_reverse_iterator(its), executions_.rend(), is_fence);
    std::vector<ReadRequest> batch;
    for (auto one = before.base(); one != executions_.end() && !is_fence(*one); ++one)
        batch.push_back({one->read.text, one->error});
    return its != executions_.end() && explained_twice(batch);
}

void Ledger::check_executed(const Entry& entry, const Answer& answer, Micros now) {
    const Micros since = sent(entry);
    for (std::size_t i = executions_.size(); i-- > 0;) {
        Execution& execution = executions_[i];
        if (execution.read.at < since) break;
        if (execution.used || execution.error >= 0) continue;
        const bool did = has(execution.read.effects, entry.command.effect);
        if (entry.command.effect ? !did : execution.read.text != entry.command.line) continue;
        // The first of those that look alike.
        bool earlier = false;
        for (std::size_t k = i; k-- > 0 && executions_[k].read.at >= since && !earlier;)
            earlier = !executions_[k].used && executions_[k].error < 0 &&
                      (entry.command.effect ? has(executions_[k].read.effects, entry.command.effect)
                                            : executions_[k].read.text == entry.command.line);
        if (earlier) continue;
        execution.used = true;
        return check_value(entry, since, answer, now);
    }
    untrue(entry, fmt::format("answered `{}`, and the board did not execute it", to_string(answer.outcome)),
           false, now);
}

// No check can say which of two requests that look alike an event answers: it must be younger than the
// first.
void Ledger::check_value(const Entry& entry, Micros since, const Answer& answer, Micros now) {
    if (entry.command.answer_tag == 0 || answer.outcome == Outcome::kUnproven) return;
    if (answer.value.empty())
        return fail(describe(entry) + " was answered `ok` without the value it asks for");
    const auto first = std::find_if(executions_.begin(), executions_.end(), [&](const Execution& execution) {
        return execution.read.at >= since && execution.read.text == entry.command.line;
    });
    const Micros executed = first == executions_.end() ? since : first->read.whole_at;
    values_.push_back(answer.value);
    const bool real = std::any_of(board_lines_.rbegin(), board_lines_.rend(), [&](const Line& line) {
        return line.at >= executed && same_value(line.text, answer.value);
    });
    if (!real && may_be_old_report(entry)) {
        ++counts.old_reports;
        note_(describe(entry) + ": a report that the session before had asked for");
    } else if (!real) {
        untrue(entry, fmt::format("got the value `{}`, which the board did not send since", answer.value),
               true, now);
    }
}

// The session had seen no report yet, only values that were asked for.
bool Ledger::may_be_old_report(const Entry& entry) const {
    const std::string report{'@', entry.command.line[0], ',', entry.command.answer_tag};
    for (std::size_t i = began_arrived_; i < entry.arrived; ++i)
        if (arrived_[i].text.starts_with(report) &&
            std::find(values_.begin(), values_.end(), without_return(arrived_[i].text)) == values_.end())
            return false;
    return std::any_of(executions_.begin(), executions_.end(), [&](const Execution& one) {
        return is_period(one.read.text) && one.read.text[0] == entry.command.line[0] && one.error < 0 &&
               !one.read.sources.empty() && one.read.sources.back() <= began_line_;
    });
}

void Ledger::check_error(const Entry& entry, const Answer& answer, Micros now) {
    const Micros since = sent(entry);
    for (std::size_t i = executions_.size(); i-- > 0;) {
        Execution& execution = executions_[i];
        if (execution.read.at < since) break;
        const auto& sources = execution.read.sources;
        const bool its = execution.read.text == entry.command.line ||
                         std::find(sources.begin(), sources.end(), entry.wire_line) != sources.end();
        if (its && has_error(execution.read.reply, answer.code)) return;
    }
    if (!damage_since(since))
        return fail(fmt::format("{} was answered by error {}, which the board did not send", describe(entry),
                                answer.code));
    ++counts.false_errors;
    note_(fmt::format("{}: an error that is not its own ({:.6f} s)", describe(entry), now * 1e-6));
}

}  // namespace truth
