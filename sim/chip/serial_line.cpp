// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/serial_line.hpp"

#include <cmath>

#include "sim/chip/garble.hpp"

namespace asip::sim {
namespace {

constexpr double kUsualBaud = 57600;  // the host's rate while it follows a board that has not opened its port
constexpr int kHostFrameBits = 10;

}  // namespace

SerialLine::SerialLine(avr_uart_t& port, AlarmClock& clock, std::uint32_t frequency, Receiver to_host)
    : usart_(port, clock,
             {[this](std::uint8_t byte, double bit_cycles) { from_board(byte, bit_cycles); },
              [this] { ++errors_.cut_by_rate_change; }}),
      frequency_(frequency),
      to_host_(std::move(to_host)),
      arrival_(clock, [this] { arrived(); }) {}

void SerialLine::send(std::string_view bytes) {
    for (const char byte : bytes)
        queue_.push_back({byte, host_baud_});
    if (!busy_ && !queue_.empty()) start_next(arrival_.clock().cycle());
}

std::uint32_t SerialLine::board_baud() const {
    if (!usart_.receiver_on() && !usart_.transmitter_on()) return 0;
    return static_cast<std::uint32_t>(std::lround(frequency_ / usart_.bit_cycles()));
}

double SerialLine::host_bit(std::uint32_t host_baud, double board_bit) const {
    if (host_baud != 0) return static_cast<double>(frequency_) / host_baud;
    return board_baud() != 0 ? board_bit : frequency_ / kUsualBaud;
}

void SerialLine::start_next(std::uint64_t cycle) {
    busy_ = true;
    byte_ = static_cast<std::uint8_t>(queue_.front().byte);
    sender_bit_ = host_bit(queue_.front().baud, usart_.bit_cycles());
    queue_.pop_front();
    lost_ = !usart_.receive_start();
    if (lost_) ++errors_.receive_overruns;
    arrival_.at(cycle + static_cast<std::uint64_t>(sender_bit_ * kHostFrameBits));
}

void SerialLine::arrived() {
    busy_ = false;
    if (!lost_) {
        const double board_bit = usart_.bit_cycles();
        if (rates_match(sender_bit_, board_bit)) {
            usart_.receive(byte_, false);
        } else {
            if (usart_.receiver_on()) ++errors_.garbled_to_board;
            for (const auto& received : receive_frame(byte_, sender_bit_, board_bit))
                usart_.receive(received.byte, received.framing_error);
        }
    }
    if (!queue_.empty()) start_next(arrival_.when());
}

void SerialLine::from_board(std::uint8_t byte, double bit_cycles) {
    const double bit = host_bit(host_baud_, bit_cycles);
    if (rates_match(bit_cycles, bit)) {
        to_host_(static_cast<char>(byte));
        return;
    }
    ++errors_.garbled_to_host;
    // As a tty in raw mode passes it on: a framing error is a zero byte.
    for (const auto& received : receive_frame(byte, bit_cycles, bit))
        to_host_(received.framing_error ? '\0' : static_cast<char>(received.byte));
}

void SerialLine::after_reset() {
    arrival_.cancel();
    queue_.clear();
    busy_ = false;
    usart_.reset();
}

}  // namespace asip::sim
