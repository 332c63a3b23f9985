// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/usart.hpp"

#include <algorithm>

namespace asip::sim {
namespace {

// UCSRnA
constexpr std::uint8_t kReceiveComplete = 0x80;
constexpr std::uint8_t kTransmitComplete = 0x40;
constexpr std::uint8_t kDataRegisterEmpty = 0x20;
constexpr std::uint8_t kFrameError = 0x10;
constexpr std::uint8_t kDataOverrun = 0x08;
constexpr std::uint8_t kDoubleSpeed = 0x02;
constexpr std::uint8_t kWritableStatus = 0x03;
// UCSRnB
constexpr std::uint8_t kReceiverOn = 0x10;
constexpr std::uint8_t kTransmitterOn = 0x08;
// UCSRnC
constexpr std::uint8_t kEightBits = 0x06;
constexpr std::uint8_t kParity = 0x20;
constexpr std::uint8_t kTwoStopBits = 0x08;

}  // namespace

Usart::Usart(avr_uart_t& port, AlarmClock& clock, Listener listener)
    : port_(port), clock_(clock), listener_(std::move(listener)), shift_end_(clock, [this] { shifted(); }) {
    take_over_registers();
    reset();
}

void Usart::take_over_registers() {
    auto& avr = clock_.avr();
    const auto take = [&](avr_io_addr_t address, bool has_read) {
        auto& io = avr.io[address - kIoBase];
        io.r.c = has_read ? read_data : nullptr;
        io.r.param = this;
        io.w.c = write_register;
        io.w.param = this;
    };
    take(port_.r_udr, true);
    for (const auto address : {port_.r_ucsra, port_.r_ucsrb, port_.r_ucsrc})
        take(address, false);
    take(static_cast<avr_io_addr_t>(port_.ubrrl.reg), false);
    take(static_cast<avr_io_addr_t>(port_.ubrrh.reg), false);
    // A level-triggered interrupt is raised again if its handler did not remove the cause.
    for (auto* vector : {&port_.rxc, &port_.udrc})
        avr_irq_register_notify(vector->irq + AVR_INT_IRQ_RUNNING, interrupt_ended, this);
}

void Usart::reset() {
    shift_end_.cancel();
    received_count_ = 0;
    overrun_ = shifting_ = cut_ = buffer_full_ = false;
    data(port_.r_ucsra) = kDataRegisterEmpty;
    data(port_.r_ucsrb) = 0;
    data(port_.r_ucsrc) = kEightBits;
}

bool Usart::receiver_on() const {
    return (data(port_.r_ucsrb) & kReceiverOn) != 0;
}
bool Usart::transmitter_on() const {
    return (data(port_.r_ucsrb) & kTransmitterOn) != 0;
}

double Usart::bit_cycles() const {
    const unsigned divider = data(static_cast<avr_io_addr_t>(port_.ubrrl.reg)) |
                             (data(static_cast<avr_io_addr_t>(port_.ubrrh.reg)) & 0x0fu) << 8;
    return (divider + 1.0) * ((data(port_.r_ucsra) & kDoubleSpeed) != 0 ? 8 : 16);
}

unsigned Usart::frame_bits() const {
    const auto control = data(port_.r_ucsrc);
    const unsigned data_bits = 5u + (control >> 1 & 3u);
    return 1 + data_bits + ((control & kParity) != 0 ? 1 : 0) + ((control & kTwoStopBits) != 0 ? 2 : 1);
}

bool Usart::receive_start() {
    if (!receiver_on() || received_count_ < received_.size()) return true;
    overrun_ = true;
    show_flags();
    return false;
}

void Usart::receive(std::uint8_t byte, bool framing_error) {
    if (!receiver_on() || received_count_ == received_.size()) return;
    received_[received_count_++] = {byte, framing_error};
    show_flags();
}

std::uint8_t Usart::read_data(avr_t* avr, avr_io_addr_t address, void* param) {
    auto& self = *static_cast<Usart*>(param);
    if (self.received_count_ > 0) {
        avr->data[address] = self.received_[0].byte;
        std::copy(self.received_.begin() + 1, self.received_.end(), self.received_.begin());
        --self.received_count_;
        self.overrun_ = false;
        self.show_flags();
    }
    return avr->data[address];
}

void Usart::write_register(avr_t*, avr_io_addr_t address, std::uint8_t value, void* param) {
    auto& self = *static_cast<Usart*>(param);
    const auto bit_before = self.bit_cycles();
    if (address == self.port_.r_udr)
        self.write_data(value);
    else if (address == self.port_.r_ucsra)
        self.write_status(value);
    else if (address == self.port_.r_ucsrb)
        self.write_control(value);
    else
        self.data(address) = value;
    self.after_rate_change(bit_before);
}

void Usart::write_data(std::uint8_t value) {
    if (!transmitter_on()) return;
    if (!shifting_) {
        start_shifting(value, clock_.cycle());
    } else {
        buffer_ = value;
        buffer_full_ = true;
    }
    show_flags();
}

void Usart::write_status(std::uint8_t value) {
    auto& status = data(port_.r_ucsra);
    status = static_cast<std::uint8_t>((status & ~kWritableStatus) | (value & kWritableStatus));
    if ((value & kTransmitComplete) != 0) {
        status = static_cast<std::uint8_t>(status & ~kTransmitComplete);
        avr_clear_interrupt(&clock_.avr(), &port_.txc);
    }
}

void Usart::write_control(std::uint8_t value) {
    data(port_.r_ucsrb) = value;
    if ((value & kReceiverOn) == 0) received_count_ = 0;
    if ((data(port_.r_ucsra) & kTransmitComplete) != 0) avr_raise_interrupt(&clock_.avr(), &port_.txc);
    show_flags();
}

void Usart::after_rate_change(double bit_before) {
    if (shifting_ && bit_before != bit_cycles()) cut_ = true;
}

void Usart::start_shifting(std::uint8_t value, std::uint64_t start) {
    shift_ = value;
    shifting_ = true;
    cut_ = false;
    shift_bit_cycles_ = bit_cycles();
    shift_end_.at(start + static_cast<std::uint64_t>(frame_bits() * shift_bit_cycles_));
}

void Usart::shifted() {
    const auto byte = shift_;
    const auto bit = shift_bit_cycles_;
    const bool cut = cut_;
    shifting_ = false;
    if (buffer_full_) {
        buffer_full_ = false;
        start_shifting(buffer_, shift_end_.when());
    } else {
        avr_raise_interrupt(&clock_.avr(), &port_.txc);
    }
    show_flags();
    if (cut)
        listener_.cut();
    else
        listener_.sent(byte, bit);
}

/// Writes the level-triggered flags and makes their interrupts pending or not. simavr looks at the flags in
/// memory.
void Usart::show_flags() {
    auto& avr = clock_.avr();
    auto& status = data(port_.r_ucsra);
    status = static_cast<std::uint8_t>(status & (kTransmitComplete | kWritableStatus));
    if (received_count_ > 0 && received_[0].framing_error) status |= kFrameError;
    if (overrun_) status |= kDataOverrun;
    const auto show = [&](bool on, std::uint8_t flag, avr_int_vector_t& vector) {
        if (on) {
            status |= flag;
            avr_raise_interrupt(&avr, &vector);
        } else if (vector.pending) {
            avr_clear_interrupt(&avr, &vector);
        }
    };
    show(received_count_ > 0, kReceiveComplete, port_.rxc);
    show(!buffer_full_, kDataRegisterEmpty, port_.udrc);
}

void Usart::interrupt_ended(avr_irq_t*, std::uint32_t running, void* param) {
    if (running == 0) static_cast<Usart*>(param)->show_flags();
}

}  // namespace asip::sim
