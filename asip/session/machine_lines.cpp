// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "asip/protocol/board_info.hpp"
#include "asip/protocol/body.hpp"
#include "asip/session/machine.hpp"

namespace asip::session {

namespace {

constexpr std::size_t kSampleBytes = 32;
constexpr std::string_view kEndOfBanner = " with Services:";

std::string printable_sample(std::string_view text) {
    std::string sample(text.substr(0, kSampleBytes));
    for (char& c : sample)
        if (c < 0x20 || c > 0x7e) c = '?';
    return sample;
}

// Also the beginning of a line; names may hold bytes beyond ASCII.
bool is_text(std::string_view text) {
    const bool named = text.starts_with("@#,N") || text.starts_with("@#,?") || text.starts_with('~') ||
                       text.starts_with('!');
    return std::all_of(text.begin(), text.end(), [named](char c) {
        return (c >= 0x20 && c <= 0x7e) || c == '\r' || c == '\t' ||
               (named && static_cast<unsigned char>(c) >= 0x80);
    });
}

// `@I,a,6` or `~I,a,3` in a line: its end and the beginning of the next one were lost together. The answer to
// an echo may hold anything.
bool holds_another(std::string_view line) {
    if (line.starts_with("@#,E") || line.starts_with('!')) return false;
    constexpr std::string_view kBegins = "@~";
    for (auto at = protocol::find_any(line, kBegins, 1); at != line.npos;
         at = protocol::find_any(line, kBegins, at + 1)) {
        const auto next = line.substr(at + 1);
        if (next.size() < 3 || next[1] != ',' || next[2] == ',') continue;
        const bool is_service = next[0] == '#' || (next[0] >= 'A' && next[0] <= 'Z');
        if (is_service && (next.size() == 3 || next[3] == ',')) return true;
    }
    return false;
}

}  // namespace

void Machine::receive(std::string_view bytes, Time now, Actions& out) {
    if (std::holds_alternative<Down>(state_) || bytes.empty()) return;
    counters_.bytes_in += bytes.size();
    last_byte_ = now;
    asked_at_.reset();
    if (auto* const searching = std::get_if<Searching>(&state_)) searching->search.bytes_came();
    auto& reader = wire_.reader();
    reader.push(bytes, [&](std::string_view line) { on_line(line, now, out); });
    if (std::holds_alternative<Ready>(state_) && !wire_.at_start_rate() && !is_text(reader.partial())) {
        // At a wrong rate a line end may never come.
        const std::string noise(reader.partial());
        reader.reset();
        garbage("not text", noise, now, out);
    }
    if (reader.overlong_lines() != overlong_seen_) {
        overlong_seen_ = reader.overlong_lines();
        garbage("line too long", {}, now, out);
    }
    // What is still unanswered was asked before these bytes; from now on it counts anew.
    if (!std::holds_alternative<Ready>(state_) || queue_.in_flight()) asked_at_ = asked_at_.value_or(now);
}

void Machine::on_line(std::string_view line, Time now, Actions& out) {
    ++counters_.lines_in;
    const Wire::Received received = wire_.unpack(line);
    if (received.damaged) {
        ++counters_.checksum_errors;
        return garbage("checksum missing or wrong", line, now, out);
    }
    if (received.had_checksum && !wire_.writes_checksums()) checksums_seen_ = true;
    line = received.text;
    const auto message = protocol::parse_line(line);
    if (line.find(kEndOfBanner, 1) != std::string_view::npos &&
        !std::holds_alternative<protocol::Info>(message))
        return on_malformed("it ends in a banner", line, now, out);
    if (!received.had_checksum && holds_another(line)) return garbage("two lines in one", line, now, out);
    if (const auto* event = std::get_if<protocol::Event>(&message))
        return std::visit([&](auto& state) { on_event(state, *event, line, now, out); }, state_);
    if (const auto* error = std::get_if<protocol::ErrorReply>(&message))
        return std::visit([&](auto& state) { on_error(state, *error, line, now, out); }, state_);
    if (const auto* info = std::get_if<protocol::Info>(&message)) return on_info(*info, line, now, out);
    on_malformed(std::get<protocol::Malformed>(message).reason, line, now, out);
}

void Machine::on_info(const protocol::Info& info, std::string_view line, Time now, Actions& out) {
    const auto banner = protocol::parse_banner(info.text);
    // Half a banner is one, too: its end cannot come from anything else.
    const bool half = !banner && info.text.find(kEndOfBanner) != std::string_view::npos;
    out.emplace_back(BoardLine{protocol::ParsedLine(line, info), std::nullopt});
    if (!banner && !half) return;
    banner_ = true;
    reports_.clear();
    if (banner) banner_services_ = banner->services;
    if (leaving_ || (there_ && !std::holds_alternative<Searching>(state_)))
        board_restarted("it sent its banner", now, out);
    else
        identify(now, out);
    queue_.board_restarted();
}

void Machine::on_malformed(std::string_view reason, std::string_view line, Time now, Actions& out) {
    if (line.find(kEndOfBanner) != std::string_view::npos && std::holds_alternative<Ready>(state_))
        return board_restarted("it sent its banner, of which the beginning is lost", now, out);
    garbage(std::string(reason), line, now, out);
}

void Machine::note_garbage(std::string reason, std::string_view line, Actions& out) {
    ++counters_.garbage;
    out.emplace_back(Garbage{std::move(reason), printable_sample(line)});
    queue_.doubt();
}

void Machine::garbage(std::string reason, std::string_view line, Time now, Actions& out) {
    note_garbage(std::move(reason), line, out);
    std::visit([&](auto& state) { on_garbage(state, now, out); }, state_);
}

}  // namespace asip::session
