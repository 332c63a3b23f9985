// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <functional>

namespace asip::test {

using namespace std::chrono_literals;

/// How long a test waits for what should happen at once; generous, because two cores run everything.
inline constexpr std::chrono::milliseconds kDeadline = std::chrono::seconds(60);

/// Asks `condition` every few milliseconds until it holds. False: it did not within `limit`.
bool wait_until(const std::function<bool()>& condition, std::chrono::milliseconds limit = kDeadline);

}  // namespace asip::test
