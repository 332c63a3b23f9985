#pragma once
#include <string_view>

namespace asip::bus {

/// `text` against a pattern with `*` and `?`; an empty pattern matches everything.
bool matches_pattern(std::string_view pattern, std::string_view text);

}  // namespace asip::bus
