// SPDX-License-Identifier: Apache-2.0
#include "tests/firmware/arguments.hpp"

#include <algorithm>

namespace wire {

namespace {

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

std::string_view trim(std::string_view text) {
    while (!text.empty() && text.front() == ' ')
        text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ')
        text.remove_suffix(1);
    return text;
}

Arguments::Are both(Arguments::Are one, Arguments::Are other) {
    if (one == Arguments::kWrong || other == Arguments::kWrong) return Arguments::kWrong;
    return one == Arguments::kGood ? other : one;
}

}  // namespace

Number Number::of(std::string_view text, bool is_signed) {
    constexpr Number kWrong{Arguments::kWrong, 0};
    constexpr std::int32_t kMaxSigned = 32'767, kMaxNumber = 65'535;
    text = trim(text);
    const bool negative = text.starts_with('-');
    if (negative) text.remove_prefix(1);
    if (text.empty() || !is_digit(text.front())) return kWrong;
    std::int32_t value = 0;
    std::size_t i = 0;
    for (; i < text.size() && is_digit(text[i]); ++i)
        if ((value = value * 10 + (text[i] - '0')) > kMaxNumber) return kWrong;
    Arguments::Are is = Arguments::kGood;
    if (negative) {
        if (!is_signed && value != 0) return kWrong;
        if (!is_signed) is = Arguments::kEither;
        value = -value;
    }
    // A service may have its own bounds.
    if (is_signed && (value > kMaxSigned || value < -kMaxSigned)) is = Arguments::kEither;
    if (i == text.size()) return {is, value};
    if (text[i] != '.') return kWrong;
    // What follows a decimal point does not count; the page does not say that it may be anything.
    const auto rest = text.substr(i + 1);
    return {!rest.empty() && std::all_of(rest.begin(), rest.end(), is_digit) ? is : Arguments::kEither,
            value};
}

Arguments arguments_of_numbers(std::string_view rest) {
    if (rest.empty()) return {};
    rest.remove_prefix(1);
    const auto comma = rest.find(',');
    const auto first = Number::of(rest.substr(0, comma), true);
    if (comma == std::string_view::npos) return {first.is, first.value, -1, {}};
    const auto second = Number::of(rest.substr(comma + 1), false);
    return {both(first.is, second.is), first.value, second.value, {}};
}

Arguments arguments_of_pin(std::string_view rest) {
    if (rest.empty()) return {};
    rest.remove_prefix(1);
    const auto comma = rest.find(',');
    if (comma == std::string_view::npos) return {};
    const auto first = Number::of(rest.substr(0, comma), false);
    const auto second = Number::of(rest.substr(comma + 1), false);
    return {both(first.is, second.is), first.value, second.value, {}};
}

Arguments arguments_of_text(std::string_view rest) {
    if (rest.empty()) return {};
    rest.remove_prefix(1);
    const auto comma = rest.find(',');
    const auto number = Number::of(rest.substr(0, comma), false);
    const auto text = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
    return {text.empty() ? both(number.is, Arguments::kEither) : number.is, number.value, -1, text};
}

bool is_token(std::string_view rest) {
    if (rest.size() < 2 || rest.size() > 9) return false;
    return std::all_of(rest.begin() + 1, rest.end(), [](char c) {
        return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    });
}

}  // namespace wire
