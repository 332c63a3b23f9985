// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

namespace asip::test {

/// While it lives, every look-up of a host name in this process takes this long. Its getaddrinfo() stands in
/// front of the C library's, for Asio and libmosquitto as well.
class SlowLookups {
  public:
    explicit SlowLookups(std::chrono::milliseconds delay);
    ~SlowLookups();
    SlowLookups(const SlowLookups&) = delete;
    SlowLookups& operator=(const SlowLookups&) = delete;
};

}  // namespace asip::test
