#include "tests/truth/ledger.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "asip/protocol/checksum.hpp"
#include "asip/protocol/message.hpp"

namespace truth {

namespace {

namespace protocol = asip::protocol;

// A command ends by a timer that the session sets; a history calls it at that very time.
constexpr Micros kSlack = kMillisecond;
// On a calm line a board answers within this, be its answer long and its loop slow.
// What was damaged before a stall arrives behind it.
constexpr Micros kLongestStall = 4 * kSecond;
// And executes within this what was sent.
constexpr Micros kCalmDelay = 150 * kMillisecond;
constexpr Micros kPeriodChanges = 1200 * kMillisecond;
constexpr Micros kCalmAnswer = 800 * kMillisecond;

std::string_view without_checksum(std::string_view line) {
    if (const auto checked = protocol::verify_checksum(line)) return *checked;
    return line;
}

std::string_view without_return(std::string_view line) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

// As the board reads it: what is behind its last character does not count.
std::string_view without_end(std::string_view line) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
        line.remove_suffix(1);
    return line;
}

int error_code(const std::string& reply) {
    if (reply.empty() || reply[0] != '~') return -1;
    const auto message = protocol::parse_line(std::string_view(reply).substr(0, reply.find('}') + 1));
    const auto* const error = std::get_if<protocol::ErrorReply>(&message);
    return error ? error->code : -1;
}

bool has(const std::vector<Effect>& effects, const std::optional<Effect>& wanted) {
    return wanted && std::find(effects.begin(), effects.end(), *wanted) != effects.end();
}

bool is_period(std::string_view line) {
    return line.size() > 3 && line[0] != '#' && line[2] == 'A';
}

}  // namespace

const char* to_string(Outcome outcome) {
    constexpr const char* kNames[] = {"ok", "unproven", "error", "doubt", "no value", "timeout", "not sent"};
    return kNames[static_cast<int>(outcome)];
}

void Counts::add(const Counts& other) {
    histories += other.histories;
    commands += other.commands;
    refused += other.refused;
    incidents += other.incidents;
    not_executed += other.not_executed;
    wrong_values += other.wrong_values;
    wrong_summed += other.wrong_summed;
    false_errors += other.false_errors;
    for (unsigned i = 0; i < kOutcomes; ++i)
        outcomes[i] += other.outcomes[i];
    for (unsigned i = 0; i < kFaults; ++i)
        faults[i] += other.faults[i];
}

void Ledger::fail(std::string what) {
    if (failed()) return;
    failure_ = std::move(what);
    note_("FAILED: " + failure_);
}

std::string Ledger::describe(const Entry& entry) const {
    return fmt::format("command #{} `{}`", &entry - entries_.data(), entry.command.line);
}

// --- what clients and session do

std::size_t Ledger::submitted(Command command, Micros now) {
    Entry entry;
    entry.submitted = now;
    entry.deadline = now + command.lasts;
    entry.command = std::move(command);
    last_deadline_ = std::max(last_deadline_, entry.deadline);
    by_line_[entry.command.line].push_back(entries_.size());
    turns_.waits(entry.command.client, entries_.size());
    if (entry.command.answer_tag != 0) turns_.give_up();  // it may have to wait for another's value
    entries_.push_back(std::move(entry));
    ++open_;
    ++counts.commands;
    return entries_.size() - 1;
}

void Ledger::refused(std::size_t command, Micros) {
    entries_[command].state = State::kEnded;
    entries_[command].ended = entries_[command].submitted;
    turns_.gone(entries_[command].command.client, command);
    --open_;
    ++counts.refused;
}

Ledger::Entry* Ledger::waiting_for(const std::string& line) {
    const auto known = by_line_.find(line);
    if (known == by_line_.end()) return nullptr;
    for (const std::size_t index : known->second)
        if (entries_[index].state == State::kWaiting && !entries_[index].abandoned) return &entries_[index];
    return nullptr;
}

// Questions of the session, its fences, and the settings that it restores.
bool Ledger::may_be_own(const std::string& line) const {
    if (line.empty() || line[0] == '#') return true;
    if (line == "I,M" || line == "I,m" || line == "I,p" || line == "I,c") return true;
    return (line.starts_with("I,P,") || is_period(line)) && by_line_.contains(line);
}

std::uint32_t Ledger::wrote(const std::string& written, Micros now) {
    const bool checksum = protocol::verify_checksum(written).has_value();
    const std::string line(without_checksum(written));
    ++wire_line_;
    damaged_to_board_.resize(wire_line_ + 1);
    if (Entry* const entry = waiting_for(line)) {
        entry->state = State::kSent;
        entry->sent = now;
        entry->wire_line = wire_line_;
        entry->checksum = checksum;
        entry->arrived = arrived_.size();
        take_turn(*entry);
        if (now > entry->deadline) fail(describe(*entry) + " was sent after its deadline");
    } else if (!may_be_own(line)) {
        fail(fmt::format("`{}` was sent, and no command waits for it", line));
    }
    if (line.starts_with("#,E,") || line.starts_with("#,V,")) fences_.push_back({now, '@' + line});
    return wire_line_;
}

void Ledger::take_turn(const Entry& entry) {
    const auto index = static_cast<std::size_t>(&entry - entries_.data());
    const auto& alike = by_line_[entry.command.line];
    const bool unknown =
        may_be_own(entry.command.line) || std::any_of(alike.begin(), alike.end(), [&](std::size_t other) {
            return other != index && entries_[other].state == State::kWaiting && !entries_[other].abandoned;
        });
    if (unknown) turns_.give_up();
    if (const auto wrong = turns_.sent(entry.command.client, index)) fail("not in turn: " + *wrong);
}

void Ledger::session_ended(Micros now) {
    turns_.all_gone();
    for (Entry& entry : entries_) {
        if (entry.state == State::kEnded || entry.abandoned) continue;
        entry.abandoned = true;
        entry.ended = now;
        --open_;
    }
}

void Ledger::finish() {
    for (const Entry& entry : entries_)
        if (entry.state != State::kEnded && !entry.abandoned) fail(describe(entry) + " was never answered");
}

// --- what line and board do

void Ledger::fault(bool to_board, Fault fault, const WireByte& byte, Micros now) {
    ++counts.faults[static_cast<unsigned>(fault)];
    if (fault == Fault::kStalled) return;
    if (fault == Fault::kOverrun) {
        if (calm_) fail("the board's receive buffer overran");
        return;
    }
    damage_.push_back(now);
    if (to_board && byte.line < damaged_to_board_.size()) damaged_to_board_[byte.line] = true;
}

void Ledger::board_read(BoardRead read) {
    read.text = without_end(without_checksum(without_end(read.text)));
    Execution execution{std::move(read)};
    execution.error = error_code(execution.read.reply);
    if (execution.error < 0) check_late(execution.read);
    executions_.push_back(std::move(execution));
}

void Ledger::check_late(const BoardRead& read) {
    if (read.sources.size() != 1 || damaged_to_board_[read.sources[0]]) return;
    const auto known = by_line_.find(read.text);
    if (known == by_line_.end()) return;
    for (const std::size_t index : known->second) {
        const Entry& entry = entries_[index];
        if (entry.wire_line != read.sources[0]) continue;
        if (entry.state == State::kWaiting) fail(describe(entry) + " was executed before it was sent");
        if (calm_ && read.at > entry.deadline + kCalmDelay)
            fail(describe(entry) + " was executed after its deadline on a calm line");
    }
}

void Ledger::board_sent(std::uint32_t, std::string text, Micros now) {
    board_lines_.push_back({now, std::string(without_checksum(text))});
}

void Ledger::delivered(std::string_view bytes, Micros now) {
    for (const char c : bytes) {
        if (c != '\n') {
            partial_ += c;
            continue;
        }
        if (!partial_.empty()) arrived_.push_back({now, std::exchange(partial_, {})});
    }
}

// --- answers

void Ledger::answered(std::size_t index, Answer answer, Micros now) {
    Entry& entry = entries_[index];
    ++counts.outcomes[static_cast<unsigned>(answer.outcome)];
    if (entry.state == State::kEnded) return fail(describe(entry) + " was answered twice");
    if ((entry.state == State::kSent) == (answer.outcome == Outcome::kNotSent)) swap_with_twin(entry);
    const bool was_sent = entry.state == State::kSent;
    if (!was_sent) turns_.gone(entry.command.client, index);
    entry.state = State::kEnded;
    entry.ended = now;
    entry.doubted = answer.outcome == Outcome::kDoubt;
    --open_;
    if (now > entry.deadline + kSlack)
        fail(fmt::format("{} was answered {} ms after its deadline", describe(entry),
                         (now - entry.deadline) / 1000));
    if (was_sent && answer.outcome == Outcome::kNotSent && !may_be_own(entry.command.line))
        return fail(describe(entry) + " was sent, and answered `not sent`");
    if (!was_sent && answer.outcome != Outcome::kNotSent)
        return fail(
            fmt::format("{} was never sent, and answered `{}`", describe(entry), to_string(answer.outcome)));
    if (calm_) check_calm(entry, answer, now);
    if (answer.outcome == Outcome::kExecuted || answer.outcome == Outcome::kUnproven)
        check_executed(entry, answer, now);
    if (answer.outcome == Outcome::kBoardError) check_error(entry, answer, now);
}

// Two clients wanted the same, and what was written was taken for the other's.
void Ledger::swap_with_twin(Entry& entry) {
    const State wanted = entry.state == State::kSent ? State::kWaiting : State::kSent;
    for (const std::size_t index : by_line_[entry.command.line]) {
        Entry& twin = entries_[index];
        if (twin.state != wanted || twin.abandoned) continue;
        std::swap(entry.state, twin.state);
        turns_.give_up();
        std::swap(entry.sent, twin.sent);
        std::swap(entry.wire_line, twin.wire_line);
        std::swap(entry.checksum, twin.checksum);
        std::swap(entry.arrived, twin.arrived);
        return;
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
    // One that ended in doubt, just before it, may have got the value that was measured for both.
    const auto& twins = by_line_[entry.command.line];
    const bool after_doubt = std::any_of(twins.begin(), twins.end(), [&](std::size_t twin) {
        return entries_[twin].doubted && entries_[twin].ended <= entry.sent &&
               entries_[twin].ended >= entry.sent - kCalmDelay;
    });
    const bool unsure = answer.outcome == Outcome::kTimeout ||
                        (answer.outcome == Outcome::kNoValue && !excused && !after_doubt);
    if ((answer.outcome == Outcome::kDoubt && entry.command.prove && !behind_error) ||
        (unsure && !hurried && !may_be_own(entry.command.line)))
        fail(fmt::format("{} was answered `{}` on a calm line", describe(entry), to_string(answer.outcome)));
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

// Which of two requests that look alike an event answers, nobody can say: it must be younger than the first.
void Ledger::check_value(const Entry& entry, Micros since, const Answer& answer, Micros now) {
    if (entry.command.answer_tag == 0 || answer.outcome == Outcome::kUnproven) return;
    if (answer.value.empty())
        return fail(describe(entry) + " was answered `ok` without the value it asks for");
    const auto first = std::find_if(executions_.begin(), executions_.end(), [&](const Execution& execution) {
        return execution.read.at >= since && execution.read.text == entry.command.line;
    });
    const Micros executed = first == executions_.end() ? since : first->read.at;
    const bool real = std::any_of(board_lines_.rbegin(), board_lines_.rend(), [&](const Line& line) {
        return line.at >= executed && line.text == answer.value;
    });
    if (!real)
        untrue(entry, fmt::format("got the value `{}`, which the board did not send since", answer.value),
               true, now);
}

void Ledger::check_error(const Entry& entry, const Answer& answer, Micros now) {
    const Micros since = sent(entry);
    for (std::size_t i = executions_.size(); i-- > 0;) {
        Execution& execution = executions_[i];
        if (execution.read.at < since) break;
        const auto& sources = execution.read.sources;
        const bool its = execution.read.text == entry.command.line ||
                         std::find(sources.begin(), sources.end(), entry.wire_line) != sources.end();
        if (execution.error == answer.code && its) return;
    }
    if (!damage_since(since))
        return fail(fmt::format("{} was answered by error {}, which the board did not send", describe(entry),
                                answer.code));
    ++counts.false_errors;
    note_(fmt::format("{}: an error that is not its own ({:.6f} s)", describe(entry), now * 1e-6));
}

bool Ledger::verified(const Entry& entry) const {
    return std::any_of(fences_.rbegin(), fences_.rend(), [&](const Line& fence) {
        return fence.at >= entry.sent && fence.text.starts_with("@#,V,");
    });
}

void Ledger::untrue(const Entry& entry, std::string what, bool is_value, Micros now) {
    const std::string text = describe(entry) + ": " + what;
    if (!damage_since(entry.sent) && !merged(entry)) return fail(text + "; the line was good");
    if (const auto sign = sign_since(entry, now)) return fail(text + "; a sign of damage: " + *sign);
    if (!is_value && verified(entry)) return fail(text + "; its fence was verified");
    ++(!is_value ? counts.not_executed : entry.checksum ? counts.wrong_summed : counts.wrong_values);
    note_(text + "; nothing showed that");
}

// The end of the line before it was damaged, and the board read both as one.
bool Ledger::merged(const Entry& entry) const {
    return std::any_of(executions_.begin(), executions_.end(), [&](const Execution& execution) {
        const auto& sources = execution.read.sources;
        return sources.size() > 1 &&
               std::find(sources.begin(), sources.end(), entry.wire_line) != sources.end();
    });
}

bool Ledger::damage_since(Micros from) const {
    return !damage_.empty() && damage_.back() >= from - kLongestStall;
}

std::optional<std::string> Ledger::sign_since(const Entry& entry, Micros now) const {
    // Which of the lines that look like it was this command, and which the session's own question?
    if (may_be_own(entry.command.line)) return std::nullopt;
    for (std::size_t i = entry.arrived; i < arrived_.size(); ++i)
        if (is_sign(entry, arrived_[i].text, arrived_[i].at))
            return fmt::format("`{}` at {:.6f} s", arrived_[i].text, arrived_[i].at * 1e-6);
    bool later_answered = false;
    for (std::size_t i = fences_.size(); i-- > 0 && fences_[i].at >= entry.sent;) {
        const std::string& answer = fences_[i].text;
        const bool answered = std::any_of(arrived_.rbegin(), arrived_.rend(), [&](const Line& line) {
            return line.at <= now && line.text.starts_with(answer);
        });
        if (!answered && later_answered) return answer + " never came";
        later_answered = later_answered || answered;
    }
    return std::nullopt;
}

bool Ledger::is_sign(const Entry& entry, const std::string& arrived, Micros at) const {
    const std::string_view line = without_return(arrived);
    if (line.empty()) return false;
    if (entry.checksum && line[0] != '!' && !protocol::verify_checksum(line)) return true;
    const auto message = protocol::parse_line(without_checksum(line));
    if (std::holds_alternative<protocol::Malformed>(message)) return true;
    if (line.find(" with Services:") != std::string_view::npos) return true;
    const auto* const error = std::get_if<protocol::ErrorReply>(&message);
    return error && !blames_another(entry, at, error->service, error->tag);
}

// Whether an error could be that of another request under way.
bool Ledger::blames_another(const Entry& entry, Micros then, char service, char tag) const {
    return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& other) {
        if (&other == &entry || other.sent > then || other.ended < then) return false;
        const std::string& line = other.command.line;
        return (line[0] == service && line[2] == tag) || tag == '?' || service == 'Q';
    });
}

}  // namespace truth
