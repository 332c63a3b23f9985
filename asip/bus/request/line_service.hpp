// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::bus {

/// In place of a service: the bytes that go over the line of a board. No pattern means it.
inline constexpr std::string_view kLineService = "$line";

}  // namespace asip::bus
