// SPDX-License-Identifier: Apache-2.0
#include "sim/program/worker.hpp"

#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

namespace asip::sim {

namespace {

constexpr std::chrono::nanoseconds kIdleSlice = std::chrono::milliseconds(1);

}  // namespace

Worker::Worker(std::vector<std::unique_ptr<LiveBoard>> boards, std::chrono::nanoseconds slice)
    : boards_(std::move(boards)),
      slice_(slice),
      woken_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_([this] { run(); }) {}

Worker::~Worker() {
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
    }
    wake();
    thread_.join();
}

void Worker::post(std::function<void(std::vector<std::unique_ptr<LiveBoard>>&)> task) {
    {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    wake();
}

void Worker::wake() {
    if (woken_.valid()) eventfd_write(woken_.number(), 1);
}

void Worker::run() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);  // signals are the main thread's
    prctl(PR_SET_TIMERSLACK, 1000);             // nanoseconds; the usual 50 us would be half of a short slice
    auto due = Clock::now();
    while (do_tasks()) {
        auto pace = Pace::kIdle;
        for (auto& board : boards_)
            pace = std::min(pace, board->tick(Clock::now()));
        if (pace == Pace::kBehind) continue;
        const auto now = Clock::now();
        due = std::clamp(due, now - 2 * slice_, now) +
              (pace == Pace::kBusy ? slice_ : std::max(slice_, kIdleSlice));
        wait_until(due);
    }
}

void Worker::wait_until(Time due) {
    waits_.assign(1, {woken_.number(), POLLIN, 0});
    for (const auto& board : boards_)
        board->add_waits(waits_);
    const auto left = std::max<std::chrono::nanoseconds>(due - Clock::now(), {});
    const timespec timeout{0, static_cast<long>(left.count())};
    eventfd_t count = 0;
    if (ppoll(waits_.data(), waits_.size(), &timeout, nullptr) > 0 && (waits_[0].revents & POLLIN) != 0)
        eventfd_read(woken_.number(), &count);
}

bool Worker::do_tasks() {
    decltype(tasks_) tasks;
    {
        const std::scoped_lock lock(mutex_);
        if (stop_) return false;
        tasks.swap(tasks_);
    }
    for (auto& task : tasks)
        task(boards_);
    return true;
}

}  // namespace asip::sim
