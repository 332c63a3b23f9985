// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace asip {

/// Acknowledges at once what was read from a TCP socket. A peer with Nagle's algorithm (Mosquitto unless told
/// otherwise, most boards with a network) keeps a small packet back until the one before is acknowledged,
/// which Linux delays by 40 ms. The option holds for some acknowledgements only (tcp(7)): call it after each
/// read.
inline void acknowledge_at_once(int socket) {
    const int on = 1;
    (void)setsockopt(socket, IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on);
}

}  // namespace asip
