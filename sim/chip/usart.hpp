// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "sim/chip/alarm.hpp"
#include "sim/chip/simavr.hpp"

namespace asip::sim {

/// The serial port by its data sheet. simavr 1.6 counts 11 bits a byte, lacks a transmit buffer and has 63
/// bytes of receive buffer in place of two, so that slow firmware works there and fails on a board.
class Usart {
  public:
    struct Listener {
        std::function<void(std::uint8_t byte, double bit_cycles)> sent;  ///< its stop bit has just ended
        /// The firmware changed the rate before the byte's end.
        std::function<void()> cut;
    };

    /// Takes over the registers of `port`.
    Usart(avr_uart_t& port, AlarmClock& clock, Listener listener);

    /// After simavr's own reset.
    void reset();

    /// A start bit arrives. False: the byte will be lost to an overrun.
    bool receive_start();
    /// Ignored while the receiver is off.
    void receive(std::uint8_t byte, bool framing_error);

    bool receiver_on() const;
    bool transmitter_on() const;
    double bit_cycles() const;
    unsigned frame_bits() const;

  private:
    struct Received {
        std::uint8_t byte;
        bool framing_error;
    };

    static std::uint8_t read_data(avr_t* avr, avr_io_addr_t address, void* param);
    static void write_register(avr_t* avr, avr_io_addr_t address, std::uint8_t value, void* param);
    static void interrupt_ended(avr_irq_t* irq, std::uint32_t running, void* param);

    void take_over_registers();
    void write_data(std::uint8_t value);
    void write_status(std::uint8_t value);
    void write_control(std::uint8_t value);
    void after_rate_change(double bit_before);
    void start_shifting(std::uint8_t value, std::uint64_t start);
    void shifted();
    void show_flags();
    std::uint8_t& data(avr_io_addr_t address) const { return clock_.avr().data[address]; }

    avr_uart_t& port_;
    AlarmClock& clock_;
    Listener listener_;
    Alarm shift_end_;

    std::array<Received, 3> received_{};  // the chip's two-byte buffer and its shift register
    unsigned received_count_ = 0;
    bool overrun_ = false;

    bool shifting_ = false;
    bool cut_ = false;
    bool buffer_full_ = false;
    std::uint8_t shift_ = 0;
    std::uint8_t buffer_ = 0;
    double shift_bit_cycles_ = 0;
};

}  // namespace asip::sim
