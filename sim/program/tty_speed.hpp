// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace asip::sim {

/// The speed of a terminal in baud, any number (500000, 250000), 0 if it has none. In a file of its own
/// because the kernel's header for it and the C library's exclude each other.
std::uint32_t tty_speed(int descriptor);

}  // namespace asip::sim
