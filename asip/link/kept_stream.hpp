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

/// What happens to a serial board when its port is opened. Boards with a DTR reset restart when DTR rises,
/// and Linux raises it at the first opening.
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

/// The way to a board is open.
struct StreamOpened {
    unsigned baud = 0;        ///< rate of the line; 0 on TCP
    bool restarting = false;  ///< the board was restarted by DTR just now
    std::string name;         ///< the name it was opened by: `/dev/serial/by-id/...`, `HOST:PORT`
};

/// Keeps the way to a board open: opens the port or the connection, and again 250 ms after it was lost or
/// could not be opened, until stop(). One thread: all calls and handlers on the io_context, and no handler is
/// called from inside a call. Handlers may stop or destroy it.
class KeptStream {
  public:
    /// A peer that accepts no more bytes is given up when this many wait.
    static constexpr std::size_t kMaxUnsentBytes = 4096;

    struct Handlers {
        std::function<void(const StreamOpened&)> on_up;
        /// It was open and is no longer.
        std::function<void(const StreamError&)> on_down;
        /// Bytes as they came; valid during the call only.
        std::function<void(std::string_view)> on_bytes;
        /// An attempt to open failed; called for each attempt.
        std::function<void(const StreamError&)> on_failed;
    };

    /// `io` must outlive it. Nothing is opened before start().
    KeptStream(boost::asio::io_context& io, StreamTarget target, Handlers handlers);
    ~KeptStream();
    KeptStream(const KeptStream&) = delete;
    KeptStream& operator=(const KeptStream&) = delete;

    void start();
    /// Closes what is open, without on_down. No handler is called any more, until start() is called again.
    void stop();

    /// Sends `bytes` after what was written before; nothing where the way is not open. Never blocks.
    void write(std::string_view bytes);
    /// Sets the line's rate once all that was written has left, then calls `done` with whether the driver can
    /// run at it. What is written meanwhile leaves afterwards. On TCP `done` gets false. `done` is not called
    /// when the port is lost first.
    void set_rate(unsigned baud, std::function<void(bool)> done);
    /// Restarts a serial board by DTR; on_up is called again, with `restarting`. False: not open, or a port
    /// without that line.
    bool restart_board();
    /// Gives up what is open and opens it again: for a connection that is open but mute. on_down is called
    /// with `why`.
    void reopen(std::string why);

  private:
    class Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace asip::link
