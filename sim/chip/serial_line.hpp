// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <string_view>

#include "sim/board.hpp"
#include "sim/chip/alarm.hpp"
#include "sim/chip/usart.hpp"

namespace asip::sim {

/// Between host and chip. A byte takes ten bit times; where rates differ, both receive other bytes.
class SerialLine {
  public:
    using Receiver = std::function<void(char byte)>;

    SerialLine(avr_uart_t& port, AlarmClock& clock, std::uint32_t frequency, Receiver to_host);

    void send(std::string_view bytes);
    std::size_t sending() const { return queue_.size() + (busy_ ? 1 : 0); }

    void set_host_baud(std::uint32_t baud) { host_baud_ = baud; }
    std::uint32_t host_baud() const { return host_baud_; }
    std::uint32_t board_baud() const;
    const LineErrors& errors() const { return errors_; }

    void after_reset();

  private:
    struct Queued {
        char byte;
        std::uint32_t baud;  // of the host at send(): a real port drains before it changes its rate
    };

    double host_bit(std::uint32_t host_baud, double board_bit) const;
    void start_next(std::uint64_t cycle);
    void arrived();
    void from_board(std::uint8_t byte, double bit_cycles);

    Usart usart_;
    std::uint32_t frequency_;
    Receiver to_host_;
    Alarm arrival_;
    std::deque<Queued> queue_;
    bool busy_ = false;
    bool lost_ = false;
    std::uint8_t byte_ = 0;
    double sender_bit_ = 0;
    std::uint32_t host_baud_ = 0;
    LineErrors errors_;
};

}  // namespace asip::sim
