// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/message.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace asip::protocol {

namespace {

bool is_printable(char c) {
    return c >= 0x20 && c <= 0x7e;
}

bool is_printable_or_foreign(char c) {
    return is_printable(c) || static_cast<unsigned char>(c) >= 0x80;
}

// Where the part of a line begins that people wrote: the names of sketch and services, the words of an error.
std::size_t words_at(std::string_view line) {
    if (line.size() < 5) return line.size();
    if (line.front() == '~') return line.find('{');
    if (!line.starts_with("@#,")) return line.size();
    if (line[3] == 'N') return line.find('{');
    std::size_t at = line[3] == '?' ? 0 : std::string_view::npos;
    for (int comma = 0; comma < 6 && at != std::string_view::npos; ++comma)
        at = line.find(',', at + 1);
    return at;
}

/// `NUMBER{TEXT}`, a comma before the brace allowed, the text optional.
Message parse_error(char service, char tag, std::string_view body) {
    int code = 0;
    const auto [end, fault] = std::from_chars(body.data(), body.data() + body.size(), code);
    if (fault != std::errc{} || code < 0) return Malformed{"error without a number"};
    body.remove_prefix(static_cast<std::size_t>(end - body.data()));
    if (!body.empty() && body.front() == ',') body.remove_prefix(1);
    if (body.empty()) return ErrorReply{service, tag, code, {}};
    if (body.size() < 2 || body.front() != '{' || body.back() != '}')
        return Malformed{"error text without its braces"};
    return ErrorReply{service, tag, code, body.substr(1, body.size() - 2)};
}

}  // namespace

Message parse_line(std::string_view line) {
    if (line.empty()) return Malformed{"empty line"};
    const char kind = line.front();
    if (kind == '!') return Info{line.substr(1)};
    if (kind != '@' && kind != '~') return Malformed{"line does not begin with @, ~ or !"};
    const auto words = line.begin() + static_cast<std::ptrdiff_t>(std::min(words_at(line), line.size()));
    if (!std::all_of(line.begin(), words, is_printable) ||
        !std::all_of(words, line.end(), is_printable_or_foreign))
        return Malformed{"line holds unprintable bytes"};
    if (line.size() < 4 || line[2] != ',') return Malformed{"line has no service and tag"};
    const char service = line[1];
    const char tag = line[3];
    // The error of a service that there is not has whatever letter the request had.
    if (kind == '@' && service != '#' && (service < 'A' || service > 'Z'))
        return Malformed{"no such service letter"};
    if (tag == ',') return Malformed{"line has no tag"};
    if (line.size() > 4 && line[4] != ',') return Malformed{"tag is longer than one character"};
    const auto body = line.size() > 5 ? line.substr(5) : std::string_view{};
    if (kind == '@') return Event{service, tag, body};
    return parse_error(service, tag, body);
}

std::string_view error_name(int code) {
    static constexpr std::array<std::string_view, 12> kNames = {
        "NO_ERROR",        "INVALID_SERVICE",       "UNKNOWN_REQUEST",
        "INVALID_PIN",     "MODE_UNAVAILABLE",      "INVALID_MODE",
        "WRONG_MODE",      "INVALID_DEVICE_NUMBER", "DEVICE_NOT_AVAILABLE",
        "I2C_NOT_ENABLED", "BAD_CHECKSUM",          "BAD_ARGUMENT",
    };
    if (code < 0 || static_cast<std::size_t>(code) >= kNames.size()) return "UNKNOWN_ERROR";
    return kNames[static_cast<std::size_t>(code)];
}

ParsedLine::ParsedLine(std::string line) : text_(std::move(line)) {
    keep(parse_line(text_), text_);
}

ParsedLine::ParsedLine(std::string_view line, const Message& message) : text_(line) {
    keep(message, line);
}

void ParsedLine::keep(const Message& message, std::string_view line) {
    std::string_view part;
    if (const auto* event = std::get_if<Event>(&message)) {
        kind_ = Kind::kEvent;
        service_ = event->service;
        tag_ = event->tag;
        part = event->body;
    } else if (const auto* error = std::get_if<ErrorReply>(&message)) {
        kind_ = Kind::kError;
        service_ = error->service;
        tag_ = error->tag;
        code_ = error->code;
        part = error->text;
    }
    if (part.empty()) return;
    part_at_ = static_cast<std::size_t>(part.data() - line.data());
    part_size_ = part.size();
}

}  // namespace asip::protocol
