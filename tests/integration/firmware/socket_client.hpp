// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Client.h>

#include <string>

namespace asip::firmware {

/// An Arduino core's network client, on a socket of this computer.
class SocketClient : public Client {
  public:
    ~SocketClient() override { stop(); }
    int connect(const char* host, std::uint16_t port) override;
    std::size_t write(const std::uint8_t* bytes, std::size_t size) override;
    int available() override;
    int read() override;
    void stop() override;
    std::uint8_t connected() override;

  private:
    void receive();

    int socket_ = -1;
    bool ended_ = false;
    std::string received_;
};

}  // namespace asip::firmware
