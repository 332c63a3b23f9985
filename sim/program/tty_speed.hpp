// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace asip::sim {

/// In baud; 0: none. Apart, because the kernel's header for it and the C library's exclude each other.
std::uint32_t tty_speed(int descriptor);

}  // namespace asip::sim
