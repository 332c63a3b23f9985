// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace others {

/// Listens on a port of this machine, takes one connection and closes it; returns the port.
std::uint16_t take_one_connection();
/// Waits until it has been closed.
void wait();

}  // namespace others
