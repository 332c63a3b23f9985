// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::link {

/// Sets both directions of an open terminal to `baud`, any number the driver takes. False with errno set when
/// it fails.
bool set_terminal_baud(int fd, int baud);

/// Its present output speed, or 0.
int terminal_baud(int fd);

}  // namespace asip::link
