// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace asip::link {

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

/// Bytes to and from a board. One thread: all calls and handlers on its io_context. No handler is called
/// after close() or destruction, which closes it.
class ByteStream {
  public:
    /// No more bytes come at once.
    static constexpr std::size_t kMaxAtOnce = 4096;

    struct Handlers {
        /// At least one byte; valid during the call only.
        std::function<void(std::string_view)> on_bytes;
        /// It ended by itself; nothing follows. The handler may destroy it.
        std::function<void(const StreamError&)> on_closed;
        /// The peer sends no more, and may still read: on_closed tells of its end at a write, or never.
        /// Without this handler the stream ends here. The handler may destroy it.
        std::function<void()> on_input_ended = nullptr;
    };

    virtual ~ByteStream() = default;

    /// Begins to read; what arrived before is delivered then. Call once.
    virtual void start(Handlers handlers) = 0;

    /// Behind what was written before. Never blocks; see unsent_bytes().
    virtual void write(std::string_view bytes) = 0;

    /// Written, and not yet taken by the operating system.
    virtual std::size_t unsent_bytes() const = 0;

    /// Calls `done` once, from the loop, when the operating system has taken all that was written so far; not
    /// after close(). A later call replaces it.
    virtual void when_sent(std::function<void()> done) = 0;

    /// While paused the peer is slowed down once the system's buffers are full. What was read before may
    /// still be delivered.
    virtual void pause_reading(bool paused) = 0;

    /// Drops what is unsent. Calling it again does nothing.
    virtual void close() = 0;

    /// `/dev/ttyACM0`, `tcp://127.0.0.1:5000`.
    virtual std::string describe() const = 0;
};

}  // namespace asip::link
