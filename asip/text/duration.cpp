// SPDX-License-Identifier: Apache-2.0
#include "asip/text/duration.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "asip/text/printable.hpp"

namespace asip::text {
namespace {

struct Unit {
    std::string_view name;
    double milliseconds;
};

constexpr std::array<Unit, 6> kUnits{
    {{"", 1e3}, {"ms", 1}, {"s", 1e3}, {"m", 6e4}, {"h", 3.6e6}, {"d", 8.64e7}}};
constexpr double kMaxMilliseconds = 100.0 * 366 * 8.64e7;

std::string number_with(double number, int decimals, const char* unit) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, number, std::chars_format::fixed, decimals).ptr;
    return std::string(text, end) + unit;
}

}  // namespace

Expected<std::chrono::milliseconds> parse_duration(std::string_view text) {
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, number, std::chars_format::fixed);
    const std::string_view unit(parsed.ptr, static_cast<std::size_t>(end - parsed.ptr));
    const std::string shown = "'" + printable(text, 32) + "'";
    for (const auto& known : kUnits) {
        if (parsed.ec != std::errc{} || unit != known.name || !std::isfinite(number)) continue;
        const double milliseconds = number * known.milliseconds;
        if (std::signbit(number) || milliseconds > kMaxMilliseconds)
            return fail(shown + " is outside 0 to 100 years");
        return std::chrono::milliseconds(std::llround(milliseconds));
    }
    return fail(shown + " is not a duration; write 500ms, 10s, 15m, 12h, 7d or a number of seconds");
}

std::string duration_text(std::chrono::duration<double> duration) {
    const double seconds = duration.count();
    if (!(std::abs(seconds) * 1e3 <= kMaxMilliseconds)) return "over 100 years";
    if (seconds < 0.01) return number_with(seconds * 1e3, 2, " ms");
    if (seconds < 1) return number_with(seconds * 1e3, 0, " ms");
    if (seconds < 9.95) return number_with(seconds, 1, " s");
    if (seconds < 120) return number_with(seconds, 0, " s");
    if (seconds < 7200) return number_with(std::floor(seconds / 60), 0, " min");
    if (seconds < 172800) return number_with(std::floor(seconds / 3600), 0, " h");
    return number_with(std::floor(seconds / 86400), 0, " d");
}

}  // namespace asip::text
