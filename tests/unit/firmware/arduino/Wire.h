// SPDX-License-Identifier: Apache-2.0
// The I2C bus of a core that is not there: what Wire would do on the two wires, as text.
#pragma once

#include <cstdint>
#include <string>

class FakeWire {
  public:
    static constexpr std::size_t kRoom = 32;

    void begin() { sent_.clear(); }
    void beginTransmission(std::uint8_t address) {
        address_ = address;
        sent_.clear();
    }
    std::size_t write(std::uint8_t byte) {
        if (sent_.size() == kRoom) return 0;
        sent_ += static_cast<char>(byte);
        return 1;
    }
    std::uint8_t endTransmission(bool stop) {
        start('w');
        const bool there = address_ == chip;
        if (there) seen += std::to_string(sent_.size());
        end(stop);
        return there ? 0 : 2;
    }
    int requestFrom(int address, int count, int stop = 1) {
        start('r');
        const int got = address == chip ? count : 0;
        if (got > 0) seen += std::to_string(got);
        end(stop != 0);
        return got;
    }
    int read() { return 0x5A; }

    int chip = 60;     // the one that is there
    std::string seen;  // S for a START, its way, the count of bytes, P for a STOP
    bool owned = false;

  private:
    void start(char way) {
        seen += 'S';
        seen += way;
        owned = true;
    }
    void end(bool stop) {
        if (!stop) return;
        seen += 'P';
        owned = false;
    }

    std::string sent_;
    int address_ = 0;
};
inline FakeWire Wire;
