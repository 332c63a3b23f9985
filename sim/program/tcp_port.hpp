// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <poll.h>

#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::sim {

/// A serial port as a TCP port on 127.0.0.1, for one client at a time. Not blocking: everything happens in
/// poll().
class TcpPort {
  public:
    /// 0: any free port.
    static Expected<TcpPort> listen(int port);
    TcpPort() = default;
    ~TcpPort();
    TcpPort(TcpPort&& other) noexcept;
    TcpPort& operator=(TcpPort&& other) noexcept;

    bool is_open() const { return listener_ >= 0; }
    int port() const { return port_; }
    bool in_use() const { return client_ >= 0; }

    /// True: one came.
    bool accept();
    /// Notices that the client left.
    std::string read(std::size_t max_bytes);
    std::size_t write(std::string_view bytes);
    void drop_client();
    void add_waits(std::vector<pollfd>& waits, bool with_bytes) const;

  private:
    int listener_ = -1;
    int client_ = -1;
    int port_ = 0;
};

}  // namespace asip::sim
