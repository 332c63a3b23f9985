// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/stuck_output.hpp"

#include <unistd.h>

#include <csignal>

namespace asip::cli {
namespace {

constexpr unsigned kPatienceSeconds = 2;

// In signal handlers: no memory, no locks.
volatile std::sig_atomic_t asked_to_end = 0;
void (*volatile on_interrupt)(int) = nullptr;
void (*volatile on_terminate)(int) = nullptr;

void on_alarm(int) {
    _exit(128 + asked_to_end);
}

void on_stop(int number) {
    asked_to_end = number;
    alarm(kPatienceSeconds);
    const auto handler = number == SIGINT ? on_interrupt : on_terminate;
    if (handler != nullptr) handler(number);
}

void wrap(int number, void (*volatile& handler)(int)) {
    struct sigaction action{};
    if (sigaction(number, nullptr, &action) != 0 || (action.sa_flags & SA_SIGINFO) != 0) return;
    if (action.sa_handler == SIG_DFL || action.sa_handler == SIG_IGN || action.sa_handler == on_stop) return;
    handler = action.sa_handler;
    action.sa_handler = on_stop;
    sigaction(number, &action, nullptr);
}

}  // namespace

void end_when_stuck() {
    std::signal(SIGALRM, on_alarm);
    wrap(SIGINT, on_interrupt);
    wrap(SIGTERM, on_terminate);
}

void not_stuck() {
    alarm(0);
}

}  // namespace asip::cli
