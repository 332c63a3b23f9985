// SPDX-License-Identifier: Apache-2.0
// A serial port with a ring for each direction, both served by the interrupt of the chip's UART.
#pragma once

#include <stddef.h>
#include <stdint.h>

class ByteRing {
  public:
    static constexpr uint16_t kSize = 256;  // a power of two

    uint16_t count() const { return static_cast<uint16_t>(head_ - tail_); }
    uint16_t room() const { return static_cast<uint16_t>(kSize - count()); }
    void put(uint8_t byte) {
        bytes_[head_ % kSize] = byte;
        head_ = static_cast<uint16_t>(head_ + 1);
    }
    uint8_t take() {
        const uint8_t byte = bytes_[tail_ % kSize];
        tail_ = static_cast<uint16_t>(tail_ + 1);
        return byte;
    }
    void clear() { tail_ = head_; }

  private:
    volatile uint8_t bytes_[kSize];
    volatile uint16_t head_, tail_;
};

class ChipSerial {
  public:
    void begin(unsigned long baud);
    int read();
    int availableForWrite();
    size_t write(uint8_t byte);
    void flush();

    // From the interrupt of the UART.
    void serve();

  private:
    void fillTransmitter();

    ByteRing received_, waiting_;
};
extern ChipSerial Serial;
