// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::cli {

/// A moment as a person types it: how long before `now` (`10m`, `12h`, `7d`), or a time in UTC that may be
/// cut short behind the day, the minutes or the seconds, with or without the `Z`: `2026-11-21`,
/// `2026-11-21T10:00`. Fails with the forms.
Expected<text::WallTime> parse_moment(std::string_view text, text::WallTime now);

}  // namespace asip::cli
