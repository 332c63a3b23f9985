// SPDX-License-Identifier: Apache-2.0
// The first C++ of the documentation with the headers that it names, and those of C++, alone: compiled
// without precompiled headers.
#include <cstdio>
#include <iostream>
#include <string>

#include "asip/client/blocking_board.hpp"

namespace documented_headers {

extern const std::string documented_port;
const std::string documented_port = "/dev/asip-no-such-port";

int blocking_board() {
#include "documented/blocking_board.inc"
    return 0;
}

}  // namespace documented_headers
