// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace asip::link {

/// Why a stream could not be opened or ended.
struct StreamError {
    enum class Kind {
        kNotThere,        ///< no such device, unknown host
        kBusy,            ///< another program has the port
        kNoPermission,    ///< the user may not open the device
        kNotASerialPort,  ///< a file or another kind of device
        kUnreachable,     ///< TCP: refused, no route, or no answer in time
        kClosed,          ///< was open: unplugged, or the peer hung up
        kFailed,          ///< anything else
    };
    Kind kind = Kind::kFailed;
    std::string text{};  ///< one line for a person, with what to do
};

/// Bytes to and from a board, whatever carries them. One thread: all calls and handlers on the io_context it
/// was opened with. Destroying a stream closes it; no handler is called after close() or destruction.
class ByteStream {
  public:
    /// No more bytes come at once.
    static constexpr std::size_t kMaxAtOnce = 4096;

    struct Handlers {
        /// Bytes as they came, any number at least one; the view is valid during the call only.
        std::function<void(std::string_view)> on_bytes;
        /// The stream has ended by itself; nothing follows. The stream may be destroyed in this handler.
        std::function<void(const StreamError&)> on_closed;
        /// The peer sends no more; it may have closed, or may still read what is written: then on_closed
        /// tells of it at a write, or never. Without this handler the stream ends here. It may be destroyed
        /// in this handler.
        std::function<void()> on_input_ended = nullptr;
    };

    virtual ~ByteStream() = default;

    /// Begins to read. Call once; what arrived before is delivered then.
    virtual void start(Handlers handlers) = 0;

    /// Sends all of `bytes`, after what was written before. Never blocks; see unsent_bytes() for what is
    /// left.
    virtual void write(std::string_view bytes) = 0;

    /// Bytes that were written but not yet accepted by the operating system.
    virtual std::size_t unsent_bytes() const = 0;

    /// Calls `done` once, from the loop, when the operating system has accepted all that was written so far.
    /// Never from inside this call; never after close(). A later call replaces an earlier `done`.
    virtual void when_sent(std::function<void()> done) = 0;

    /// While paused, nothing is read: the peer is slowed down once the system's buffers are full. What was
    /// read before may still be delivered. Safe in a handler of this stream.
    virtual void pause_reading(bool paused) = 0;

    /// What is unsent is dropped. Calling it again does nothing.
    virtual void close() = 0;

    /// For logs: `/dev/ttyACM0`, `tcp://127.0.0.1:5000`.
    virtual std::string describe() const = 0;
};

}  // namespace asip::link
