// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/message.hpp"

#include <algorithm>
#include <charconv>

namespace asip::protocol {
namespace {

bool is_printable(char c) {
    return c >= 0x20 && c <= 0x7e;
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
    if (!std::all_of(line.begin(), line.end(), is_printable))
        return Malformed{"line holds unprintable bytes"};
    if (line.size() < 4 || line[2] != ',') return Malformed{"line has no service and tag"};
    const char service = line[1];
    const char tag = line[3];
    if (service != '#' && (service < 'A' || service > 'Z')) return Malformed{"no such service letter"};
    if (tag == ',') return Malformed{"line has no tag"};
    if (line.size() > 4 && line[4] != ',') return Malformed{"tag is longer than one character"};
    const auto body = line.size() > 5 ? line.substr(5) : std::string_view{};
    if (kind == '@') return Event{service, tag, body};
    return parse_error(service, tag, body);
}

}  // namespace asip::protocol
