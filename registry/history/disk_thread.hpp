// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <optional>
#include <utility>

namespace asip::registry {

/// Where a file is used: on a thread of its own, or, in simulated time, at once, so that no real disk takes
/// part in what time it is.
class DiskThread {
  public:
    explicit DiskThread(bool own) {
        if (own) thread_.emplace(1);
    }
    template <class Use>
    void post(Use use) {
        if (thread_)
            boost::asio::post(*thread_, std::move(use));
        else
            use();
    }
    /// Waits for what was posted.
    void join() {
        if (thread_) thread_->join();
    }

  private:
    std::optional<boost::asio::thread_pool> thread_;
};

}  // namespace asip::registry
