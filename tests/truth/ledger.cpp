// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/ledger.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "asip/protocol/checksum.hpp"
#include "asip/protocol/message.hpp"
#include "tests/truth/lines.hpp"

namespace truth {

namespace {

namespace protocol = asip::protocol;

// A command ends by a timer that the session sets; a history calls it at that very time.
constexpr Micros kSlack = kMillisecond;

// As the board reads it: what is behind its last character does not count.
std::string_view without_end(std::string_view line) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
        line.remove_suffix(1);
    return line;
}

// What a change of a pin caused is reported before it.
int error_code(std::string_view reply) {
    const auto begin = reply.starts_with('~') ? 0 : reply.find("\n~") + 1;
    if (!reply.substr(begin).starts_with('~')) return -1;
    reply.remove_prefix(begin);
    const auto message = protocol::parse_line(reply.substr(0, reply.find('}') + 1));
    const auto* const error = std::get_if<protocol::ErrorReply>(&message);
    return error ? error->code : -1;
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
    old_reports += other.old_reports;
    false_errors += other.false_errors;
    equal_digests += other.equal_digests;
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
    if (entry.command.urgent) turns_.give_up();
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
    // Analog reports that no client asked for, and that stopped: with the period that they seemed to have.
    if (line.starts_with("I,A,")) return true;
    if (is_restored_level(line) || is_mode_of_a_duty(line)) return true;
    return (line.starts_with("I,P,") || is_period(line)) && by_line_.contains(line);
}

// The level of a pin that a command made an output, as a command set it or the end of its hold; or what
// prepares a high level.
bool Ledger::is_restored_level(const std::string& line) const {
    const auto comma = line.rfind(',');
    const bool writes = line.starts_with("I,d,");
    if (!writes && !(line.starts_with("I,P,") && line.ends_with(",2"))) return false;
    const auto pin = line.substr(4, comma - 4);
    const bool low = writes && line.ends_with(",0");
    return by_line_.contains("I,P," + pin + ",3") &&
           (by_line_.contains("I,d," + pin + ",1") || (low && by_line_.contains(line)));
}

// A duty makes a pin a PWM pin, whatever mode a command had given it.
bool Ledger::is_mode_of_a_duty(const std::string& line) const {
    if (!line.starts_with("I,P,") || !line.ends_with(",5")) return false;
    const auto any = line.substr(0, line.size() - 1);
    return by_line_.contains(any + "1") || by_line_.contains(any + "2") || by_line_.contains(any + "3");
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
        return wire_line_;
    }
    if (!may_be_own(line)) fail(fmt::format("`{}` was sent, and no command waits for it", line));
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
    began_line_ = wire_line_;
    began_arrived_ = arrived_.size();
    for (Entry& entry : entries_) {
        if (entry.state == State::kEnded || entry.abandoned) continue;
        entry.abandoned = true;
        entry.ended = now;
        --open_;
    }
}

bool Ledger::was_executed(const std::string& line) const {
    const auto known = by_line_.find(line);
    return known != by_line_.end() &&
           std::any_of(known->second.begin(), known->second.end(),
                       [&](std::size_t index) { return entries_[index].executed; });
}

void Ledger::finish() {
    for (const Entry& entry : entries_)
        if (entry.state != State::kEnded && !entry.abandoned) fail(describe(entry) + " was never answered");
}

// --- what line and board do

void Ledger::fault(bool to_board, Fault fault, const WireByte& byte, Micros now) {
    ++counts.faults[static_cast<unsigned>(fault)];
    if (fault == Fault::kStalled) return;
    if (fault == Fault::kOverrun && calm_) fail("the board's receive buffer overran");
    damage_.push_back(now);
    if (to_board && byte.line < damaged_to_board_.size()) damaged_to_board_[byte.line] = true;
}

void Ledger::board_read(BoardRead read) {
    read.text = without_end(without_checksum(without_end(read.text)));
    const int error = error_code(read.reply);
    Execution execution{std::move(read), error};
    if (execution.error < 0) check_late(execution.read);
    executions_.push_back(std::move(execution));
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
    entry.executed = answer.outcome == Outcome::kExecuted;
    entry.without_value = answer.outcome == Outcome::kDoubt || answer.outcome == Outcome::kTimeout ||
                          answer.outcome == Outcome::kNoValue;
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

}  // namespace truth
