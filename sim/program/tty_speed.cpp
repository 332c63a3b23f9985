// SPDX-License-Identifier: Apache-2.0
#include "sim/program/tty_speed.hpp"

#include <asm/termbits.h>
#include <sys/ioctl.h>

namespace asip::sim {

std::uint32_t tty_speed(int descriptor) {
    struct termios2 settings{};
    return ioctl(descriptor, TCGETS2, &settings) == 0 ? settings.c_ospeed : 0;
}

}  // namespace asip::sim
