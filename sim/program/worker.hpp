// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <poll.h>

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "asip/descriptor.hpp"
#include "sim/program/live_board.hpp"

namespace asip::sim {

/// A thread that runs boards in turn, in slices of real time, longer ones while no line is busy.
class Worker {
  public:
    Worker(std::vector<std::unique_ptr<LiveBoard>> boards, std::chrono::nanoseconds slice);
    /// The boards go with it.
    ~Worker();

    /// On their thread, between two slices.
    void post(std::function<void(std::vector<std::unique_ptr<LiveBoard>>&)> task);

  private:
    void run();
    bool do_tasks();
    void wake();
    void wait_until(Time due);

    std::vector<std::unique_ptr<LiveBoard>> boards_;
    std::chrono::nanoseconds slice_;
    Descriptor woken_;  // an eventfd, or none: tasks wait for the end of a slice
    std::vector<pollfd> waits_;
    std::mutex mutex_;
    std::vector<std::function<void(std::vector<std::unique_ptr<LiveBoard>>&)>> tasks_;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace asip::sim
