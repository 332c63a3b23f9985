// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>

namespace boost::asio {
class io_context;
}

namespace asip::program {

/// Whether a signal is ignored, as SIGHUP is by nohup.
bool ignored(int signal);

/// Calls `stop` once, on the io_context, at the first SIGINT, SIGTERM or SIGHUP (the terminal was closed). A
/// second one ends the process at once with status 128 + signal, for when the orderly way hangs; not a
/// SIGHUP, which kernel and shell both send: once stopped, the process ignores it to its end. Keeps the
/// io_context busy until cancelled or destroyed.
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
