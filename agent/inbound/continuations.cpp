// SPDX-License-Identifier: Apache-2.0
#include "agent/inbound/continuations.hpp"

#include <atomic>
#include <csignal>

namespace asip::agent {
namespace {

std::atomic<unsigned> count = 0;
static_assert(std::atomic<unsigned>::is_always_lock_free);

extern "C" void on_continuation(int) {
    count.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

void count_continuations() {
    struct sigaction action{};
    action.sa_handler = on_continuation;
    action.sa_flags = SA_RESTART;
    sigaction(SIGCONT, &action, nullptr);
}

unsigned continuations() {
    return count.load(std::memory_order_relaxed);
}

}  // namespace asip::agent
