// SPDX-License-Identifier: Apache-2.0
#include "tests/support/wait.hpp"

#include <thread>

namespace asip::test {

bool wait_until(const std::function<bool()>& condition, std::chrono::milliseconds limit) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() >= deadline) return condition();
        std::this_thread::sleep_for(2ms);
    }
    return true;
}

}  // namespace asip::test
