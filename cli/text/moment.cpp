// SPDX-License-Identifier: Apache-2.0
#include "cli/text/moment.hpp"

#include <string>

#include "asip/text/duration.hpp"

namespace asip::cli {

Expected<text::WallTime> parse_moment(std::string_view text, text::WallTime now) {
    if (const auto ago = text::parse_duration(text)) return now - *ago;
    if (const auto time = text::parse_iso_time(text)) return *time;
    return fail("\"" + std::string(text) +
                "\" is neither how long ago (10m, 12h, 7d) nor a time in UTC (2026-11-21, 2026-11-21T10:00)");
}

}  // namespace asip::cli
