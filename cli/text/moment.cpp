// SPDX-License-Identifier: Apache-2.0
#include "cli/text/moment.hpp"

#include <string>

#include "asip/text/duration.hpp"

namespace asip::cli {

Expected<text::WallTime> parse_moment(std::string_view text, text::WallTime now) {
    if (const auto ago = text::parse_duration(text)) return now - *ago;
    constexpr std::string_view kRest = "YYYY-MM-DDT00:00:00.000Z";
    auto digits = text;
    if (digits.ends_with('Z') && digits.size() > 10) digits.remove_suffix(1);
    for (const std::size_t length : {10U, 16U, 19U, 23U}) {
        if (digits.size() != length) continue;
        if (const auto time = text::parse_iso_time(std::string(digits) + std::string(kRest.substr(length))))
            return *time;
    }
    return fail("\"" + std::string(text) +
                "\" is neither how long ago (10m, 12h, 7d) nor a time in UTC (2026-11-21, 2026-11-21T10:00)");
}

}  // namespace asip::cli
