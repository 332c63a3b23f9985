// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "asip/link/byte_stream.hpp"
#include "asip/link/tcp_stream.hpp"
#include "asip/time.hpp"

namespace asip::link {

/// Boards with a DTR reset restart when DTR rises, which Linux does at the first opening.
enum class DtrAtOpen {
    kLeave,  ///< DTR is not touched; whether the board restarted is unknown
    kRaise,  ///< DTR is raised; a port that has the line is reported as `restarting`
    kPulse,  ///< DTR goes low for 100 ms and high again: the board restarts for certain
};

/// A board at a serial port.
struct SerialTarget {
    std::string device;  ///< `/dev/ttyACM0`; after the first opening its by-id name is used, where it has one
    unsigned baud = 57600;  ///< rate at each opening
    DtrAtOpen dtr = DtrAtOpen::kLeave;
};

using StreamTarget = std::variant<SerialTarget, TcpAddress>;

struct StreamOpened {
    unsigned baud = 0;        ///< rate of the line; 0 on TCP
    bool restarting = false;  ///< the board was restarted by DTR just now
    std::string name;         ///< the name it was opened by: `/dev/serial/by-id/...`, `HOST:PORT`
};

/// Keeps the way to a board open: opens port or connection, and again 250 ms after it was lost or failed,
/// until stop(). One thread: all calls and handlers on the io_context. Handlers may stop or destroy it.
class KeptStream {
  public:
    /// With so many a peer that takes no bytes is given up.
    static constexpr std::size_t kMaxUnsentBytes = 4096;

    struct Handlers {
        std::function<void(const StreamOpened&)> on_up;
        std::function<void(const StreamError&)> on_down;
        /// Valid during the call only.
        std::function<void(std::string_view)> on_bytes;
        /// For each attempt.
        std::function<void(const StreamError&)> on_failed;
    };

    /// Nothing is opened before start().
    KeptStream(boost::asio::io_context& io, StreamTarget target, Handlers handlers);
    ~KeptStream();
    KeptStream(const KeptStream&) = delete;
    KeptStream& operator=(const KeptStream&) = delete;

    void start();
    /// Without on_down. No handler is called until start() is called again.
    void stop();

    /// Nothing where the way is not open. Never blocks.
    void write(std::string_view bytes);
    /// Sets the rate once all that was written has left, then calls `done` with whether the driver can run at
    /// it; later writes follow. On TCP `done` gets false; it is not called when the port is lost first.
    void set_rate(unsigned baud, std::function<void(bool)> done);
    /// By DTR; on_up is called again, with `restarting`. False: not open, or no such line.
    bool restart_board();
    /// For a connection that is open but mute. on_down is called with `why`.
    void reopen(std::string why);

  private:
    class Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::link
