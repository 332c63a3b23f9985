// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>

#include "tests/support/wait.hpp"

namespace asip::test {

/// Runs the loop until `condition` holds. False: it did not within `limit`. For tests that drive a program's
/// parts on an io_context of their own.
template <class Condition>
bool run_until(boost::asio::io_context& io, Condition condition,
               std::chrono::milliseconds limit = kDeadline) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() >= deadline) return condition();
        if (io.stopped()) io.restart();
        io.run_one_for(5ms);
    }
    return true;
}

/// Runs the loop for a while, to see that something does not happen.
inline void run_for(boost::asio::io_context& io, std::chrono::milliseconds time) {
    run_until(io, [] { return false; }, time);
}

}  // namespace asip::test
