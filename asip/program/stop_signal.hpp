// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>

namespace boost::asio {
class io_context;
}

namespace asip::program {

/// As SIGHUP is by nohup.
bool ignored(int signal);

/// Calls `stop` once, on the io_context, at the first SIGINT, SIGTERM or SIGHUP. A second SIGINT or SIGTERM
/// ends the process with 128 + signal, in case the orderly way hangs. Keeps the io_context busy until
/// cancelled or destroyed.
class StopSignal {
  public:
    enum class Hangup { kStops, kElsewhere };  ///< what handles SIGHUP; nothing where it is ignored

    StopSignal(boost::asio::io_context& io, std::function<void(int signal)> stop,
               Hangup hangup = Hangup::kStops);
    ~StopSignal();

    void cancel();

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace asip::program
