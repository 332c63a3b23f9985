// SPDX-License-Identifier: Apache-2.0
// The interface that Arduino cores give to their network clients, as far as it is used here.
#pragma once

#include "Arduino.h"

class Client {
  public:
    virtual ~Client() = default;
    virtual int connect(const char* host, std::uint16_t port) = 0;
    virtual std::size_t write(const std::uint8_t* bytes, std::size_t size) = 0;
    virtual int available() = 0;
    virtual int read() = 0;
    virtual void stop() = 0;
    virtual std::uint8_t connected() = 0;
};
