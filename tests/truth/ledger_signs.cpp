// SPDX-License-Identifier: Apache-2.0
// Whether damage left a sign that the session got: only an answer without one may be untrue.
#include <fmt/format.h>

#include <algorithm>

#include "asip/protocol/body.hpp"
#include "asip/protocol/message.hpp"
#include "asip/session/request.hpp"
#include "tests/truth/ledger.hpp"
#include "tests/truth/lines.hpp"

namespace truth {

namespace {

namespace protocol = asip::protocol;

// What was damaged before a stall arrives behind it, and so does the error of a request that timed out
// meanwhile.
constexpr Micros kLongestStall = 4 * kSecond;

}  // namespace

void Ledger::untrue(const Entry& entry, std::string what, bool is_value, Micros now) {
    const std::string text = describe(entry) + ": " + what;
    if (!damage_since(entry.sent) && !merged(entry)) return fail(text + "; the line was good");
    if (const auto sign = sign_since(entry, now)) return fail(text + "; a sign of damage: " + *sign);
    if (!is_value && digests_) return fail(text + "; the board has verified fences");
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
    if (const auto* const event = std::get_if<protocol::Event>(&message)) return !can_be(entry, *event);
    const auto* const error = std::get_if<protocol::ErrorReply>(&message);
    return error && !blames_another(entry, at, error->service, error->tag) &&
           !answers_another(entry, at, *error);
}

bool Ledger::can_be(const Entry& entry, const protocol::Event& event) const {
    if (!asip::session::is_well_formed(event)) return false;
    const bool is_value = event.service == entry.command.line[0] && event.tag == entry.command.answer_tag &&
                          event.service == 'D';
    return !is_value || protocol::parse_body(event.body).has_value();
}

// Whether the board refused another request, which had come to it as it was sent, with this error.
bool Ledger::answers_another(const Entry& entry, Micros at, const protocol::ErrorReply& error) const {
    return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& other) {
        if (&other == &entry || other.sent == kNever || damaged_to_board_[other.wire_line]) return false;
        if (other.command.line[0] != error.service || other.command.line[2] != error.tag) return false;
        return std::any_of(executions_.begin(), executions_.end(), [&](const Execution& one) {
            return one.error == error.code && one.read.at <= at &&
                   one.read.sources == std::vector{other.wire_line};
        });
    });
}

// Whether an error could be that of another request under way.
bool Ledger::blames_another(const Entry& entry, Micros then, char service, char tag) const {
    return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& other) {
        if (&other == &entry || other.sent > then) return false;
        if (other.ended < then && (other.ended < other.deadline || other.ended + kLongestStall < then))
            return false;
        const std::string& line = other.command.line;
        return (line[0] == service && line[2] == tag) || tag == '?' || service == 'Q';
    });
}

}  // namespace truth
