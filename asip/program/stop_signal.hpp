// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>

namespace boost::asio {
class io_context;
}

namespace asip::program {

/// Calls `stop` once, on the io_context, at the first SIGINT or SIGTERM; a second one ends the process at
/// once with status 128 + signal, for when the orderly way hangs. Keeps the io_context busy until cancelled
/// or destroyed.
class StopSignal {
  public:
    StopSignal(boost::asio::io_context& io, std::function<void(int signal)> stop);
    ~StopSignal();

    void cancel();

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace asip::program
