#include "cli/text/duration.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

namespace asip::cli {

std::string duration_text(std::chrono::duration<double> duration) {
    const double seconds = duration.count();
    if (seconds < 0.01) return fmt::format("{:.2f} ms", seconds * 1e3);
    if (seconds < 1) return fmt::format("{:.0f} ms", seconds * 1e3);
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    if (seconds < 120) return fmt::format("{:.0f} s", seconds);
    if (seconds < 7200) return fmt::format("{:.0f} min", std::floor(seconds / 60));
    if (seconds < 172800) return fmt::format("{:.0f} h", std::floor(seconds / 3600));
    return fmt::format("{:.0f} d", std::floor(seconds / 86400));
}

std::string iso_time(std::chrono::system_clock::time_point when) {
    const auto since = when.time_since_epoch();
    const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(since).count() % 1000;
    const auto seconds = std::chrono::system_clock::to_time_t(when);
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(seconds), milliseconds);
}

Expected<std::chrono::milliseconds> parse_duration(std::string_view text) {
    double number = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view unit(parsed.ptr, text.size() - static_cast<std::size_t>(parsed.ptr - text.data()));
    struct Unit {
        std::string_view name;
        double milliseconds;
    };
    constexpr std::array<Unit, 5> kUnits{{{"", 1e3}, {"ms", 1}, {"s", 1e3}, {"m", 6e4}, {"h", 3.6e6}}};
    for (const auto& known : kUnits) {
        const double result = number * known.milliseconds;
        if (parsed.ec == std::errc{} && unit == known.name && result >= 0 && result < 1e12) {
            return std::chrono::milliseconds(std::llround(result));
        }
    }
    return fail("'" + std::string(text) +
                "' is no duration; write 500ms, 10s, 5m, 2h or a number of seconds");
}

}  // namespace asip::cli
