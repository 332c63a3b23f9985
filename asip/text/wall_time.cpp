// SPDX-License-Identifier: Apache-2.0
#include "asip/text/wall_time.hpp"

#include <array>
#include <cstdint>

namespace asip::text {
namespace {

constexpr std::string_view kShape = "0000-00-00T00:00:00.000Z";

/// With what is left out at its end; of another length: zeros.
std::array<char, kShape.size()> whole_time(std::string_view text) {
    if (text.ends_with('Z') && text.size() > 10) text.remove_suffix(1);
    std::array<char, kShape.size()> whole{};
    if (text.size() != 10 && text.size() != 16 && text.size() != 19 && text.size() != 23) return whole;
    kShape.copy(whole.data(), whole.size());
    text.copy(whole.data(), text.size());
    return whole;
}

bool has_shape(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool digit = text[i] >= '0' && text[i] <= '9';
        if (kShape[i] == '0' ? !digit : text[i] != kShape[i]) return false;
    }
    return true;
}

int number_at(std::string_view text, std::size_t at, std::size_t count) {
    int value = 0;
    for (std::size_t i = at; i < at + count; ++i)
        value = value * 10 + (text[i] - '0');
    return value;
}

void put_digits(std::string& text, std::size_t at, std::size_t count, std::int64_t number) {
    for (std::size_t i = at + count; i > at; number /= 10)
        text[--i] = static_cast<char>('0' + number % 10);
}

}  // namespace

WallTime wall_now() {
    return std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
}

std::string iso_time(WallTime time) {
    const auto day = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date(day);
    const std::chrono::hh_mm_ss clock(time - day);
    const int year = static_cast<int>(date.year());
    std::string text(kShape);
    put_digits(text, 5, 2, static_cast<unsigned>(date.month()));
    put_digits(text, 8, 2, static_cast<unsigned>(date.day()));
    put_digits(text, 11, 2, clock.hours().count());
    put_digits(text, 14, 2, clock.minutes().count());
    put_digits(text, 17, 2, clock.seconds().count());
    put_digits(text, 20, 3, clock.subseconds().count());
    if (year < 0 || year > 9999) return text.replace(0, 4, std::to_string(year));
    put_digits(text, 0, 4, year);
    return text;
}

std::optional<WallTime> parse_iso_time(std::string_view written) {
    const auto whole = whole_time(written);
    const std::string_view text(whole.data(), whole.size());
    if (!has_shape(text)) return std::nullopt;
    const std::chrono::year_month_day date{std::chrono::year(number_at(text, 0, 4)),
                                           std::chrono::month(static_cast<unsigned>(number_at(text, 5, 2))),
                                           std::chrono::day(static_cast<unsigned>(number_at(text, 8, 2)))};
    const int hour = number_at(text, 11, 2);
    const int minute = number_at(text, 14, 2);
    const int second = number_at(text, 17, 2);
    if (!date.ok() || hour > 23 || minute > 59 || second > 60) return std::nullopt;
    return WallTime(std::chrono::sys_days(date)) + std::chrono::hours(hour) + std::chrono::minutes(minute) +
           std::chrono::seconds(second) + std::chrono::milliseconds(number_at(text, 20, 3));
}

}  // namespace asip::text
