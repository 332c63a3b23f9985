// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "tests/support/wait.hpp"

namespace asip::test {

/// A program at the other end of a byte stream to a board: a terminal, or a TCP connection to 127.0.0.1.
class StreamClient {
  public:
    /// Opens a terminal, raw, at a rate. Throws std::runtime_error if it is not there.
    static StreamClient terminal(const std::string& path, int baud = 57600);
    static StreamClient tcp(int port);
    static StreamClient unix_socket(const std::string& path);
    ~StreamClient();
    StreamClient(StreamClient&& other) noexcept;
    StreamClient(const StreamClient&) = delete;
    StreamClient& operator=(const StreamClient&) = delete;

    void set_baud(int baud);
    void write(std::string_view bytes);
    /// Everything that came so far.
    const std::string& received();
    /// Whether this text came within the deadline; what came up to its end is then gone from received().
    bool expect(std::string_view text, std::chrono::milliseconds limit = kDeadline);
    /// Whether the other side is gone.
    bool closed();

  private:
    explicit StreamClient(int descriptor) : descriptor_(descriptor) {}
    void read();

    int descriptor_;
    bool closed_ = false;
    std::string received_;
};

}  // namespace asip::test
