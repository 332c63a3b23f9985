// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/request_end.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "asip/protocol/request.hpp"

namespace asip::protocol {

namespace {

constexpr std::size_t kTagEnd = 3;  // S,t

struct Form {
    char service;
    char tag;
    std::size_t numbers;
};

// Each service has A,ms.
constexpr std::array kForms{
    Form{'I', 'P', 2}, Form{'I', 'd', 2}, Form{'I', 'a', 2}, Form{'S', 'W', 2}, Form{'M', 'm', 2},
    Form{'M', 'M', 2}, Form{'M', 's', 1}, Form{'M', 'r', 3}, Form{'M', 'R', 3}, Form{'M', 'a', 2},
    Form{'M', 'c', 2}, Form{'T', 'P', 2}, Form{'N', 'C', 5}, Form{'N', 'B', 2}, Form{'N', 'S', 1},
};

std::optional<std::size_t> numbers_needed(const Request& request) {
    if (request.tag == 'A' && request.service != '#') return 1;
    const auto* const known = std::find_if(kForms.begin(), kForms.end(), [&](const Form& form) {
        return form.service == request.service && form.tag == request.tag;
    });
    if (known == kForms.end()) return std::nullopt;
    return known->numbers;
}

bool is_service(char c) {
    return c == '#' || (c >= 'A' && c <= 'Z');
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// How many numbers stand there, one behind each comma; none where something else does.
std::optional<std::size_t> count_numbers(std::string_view parameters) {
    std::size_t count = 0;
    while (!parameters.empty()) {
        const auto comma = parameters.find(',');
        auto number = parameters.substr(0, comma);
        parameters.remove_prefix(comma == parameters.npos ? parameters.size() : comma + 1);
        const bool some = std::any_of(number.begin(), number.end(), is_digit);
        const bool only = std::all_of(number.begin(), number.end(),
                                      [](char c) { return is_digit(c) || c == '-' || c == '.' || c == ' '; });
        if (!some || !only) return std::nullopt;
        ++count;
    }
    return count;
}

}  // namespace

std::size_t next_request(std::string_view text) {
    if (text.empty() || text[0] == '#' || text[0] == '!' || text[0] == 'L') return text.npos;
    for (std::size_t at = kTagEnd; at + 1 < text.size(); ++at)
        if (text[at + 1] == ',' && is_service(text[at])) return at;
    return text.npos;
}

bool is_whole_request(std::string_view text) {
    text = significant(text);
    const auto request = parse_request(text);
    if (!request) return false;
    const char last = text.back();
    const auto needed = numbers_needed(*request);
    if (needed) return last != ',' && count_numbers(request->parameters) == needed;
    return text.size() <= kTagEnd + 1 || is_digit(last) || last == '}' || text[0] == 'L';
}

bool is_whole_after_silence(std::string_view text) {
    return is_whole_request(text) && (text[0] != '#' || significant(text).size() == kTagEnd);
}

}  // namespace asip::protocol
