// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <poll.h>

#include <string>
#include <string_view>
#include <vector>

#include "asip/descriptor.hpp"
#include "asip/expected.hpp"

namespace asip::sim {

/// A serial port as a TCP port on 127.0.0.1, for one client at a time. Not blocking: everything happens in
/// poll().
class TcpPort {
  public:
    /// 0: any free port.
    static Expected<TcpPort> listen(int port);
    TcpPort() = default;

    bool is_open() const { return listener_.valid(); }
    int port() const { return port_; }
    bool in_use() const { return client_.valid(); }

    /// True: one came.
    bool accept();
    /// Notices that the client left.
    std::string read(std::size_t max_bytes);
    std::size_t write(std::string_view bytes);
    void drop_client() { client_ = Descriptor(); }
    void add_waits(std::vector<pollfd>& waits, bool with_bytes) const;

  private:
    Descriptor listener_;
    Descriptor client_;
    int port_ = 0;
};

}  // namespace asip::sim
