// SPDX-License-Identifier: Apache-2.0
#include "asip/link/baud.hpp"

// The kernel's own termios2 has the speed as a number; its header cannot be included beside <termios.h>.
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <cerrno>

namespace asip::link {
namespace {

struct Named {
    int baud;
    unsigned flag;
};
/// Named speeds are asked for by their names: a peer that looks with <termios.h> then sees them.
constexpr Named kNamed[] = {
    {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},     {115200, B115200},
    {230400, B230400},   {460800, B460800},   {500000, B500000},   {576000, B576000},   {921600, B921600},
    {1000000, B1000000}, {1152000, B1152000}, {1500000, B1500000}, {2000000, B2000000}, {2500000, B2500000},
    {3000000, B3000000}, {3500000, B3500000}, {4000000, B4000000},
};

}  // namespace

bool set_terminal_baud(int fd, int baud) {
    if (baud <= 0) {
        errno = EINVAL;
        return false;
    }
    termios2 settings{};
    if (ioctl(fd, TCGETS2, &settings) != 0) return false;
    unsigned flag = BOTHER;
    for (const auto& named : kNamed)
        if (named.baud == baud) flag = named.flag;
    // Input speed bits of zero mean "the same as output".
    settings.c_cflag &= ~static_cast<unsigned>(CBAUD | (CBAUD << IBSHIFT));
    settings.c_cflag |= flag;
    settings.c_ospeed = settings.c_ispeed = static_cast<speed_t>(baud);
    return ioctl(fd, TCSETS2, &settings) == 0;
}

int terminal_baud(int fd) {
    termios2 settings{};
    return ioctl(fd, TCGETS2, &settings) == 0 ? static_cast<int>(settings.c_ospeed) : 0;
}

}  // namespace asip::link
