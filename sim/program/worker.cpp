// SPDX-License-Identifier: Apache-2.0
#include "sim/program/worker.hpp"

#include <sys/prctl.h>

#include <algorithm>
#include <csignal>

namespace asip::sim {

Worker::Worker(std::vector<std::unique_ptr<LiveBoard>> boards, std::chrono::nanoseconds slice)
    : boards_(std::move(boards)), slice_(slice), thread_([this] { run(); }) {}

Worker::~Worker() {
    {
        const std::scoped_lock lock(mutex_);
        stop_ = true;
    }
    thread_.join();
}

void Worker::post(std::function<void(std::vector<std::unique_ptr<LiveBoard>>&)> task) {
    const std::scoped_lock lock(mutex_);
    tasks_.push_back(std::move(task));
}

void Worker::run() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);  // signals are the main thread's
    prctl(PR_SET_TIMERSLACK, 1000);             // nanoseconds; the usual 50 us would be half of a short slice
    auto due = Clock::now();
    while (do_tasks()) {
        for (auto& board : boards_)
            board->tick(Clock::now());
        due = std::max(due + slice_, Clock::now() - slice_);
        std::this_thread::sleep_until(due);
    }
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
