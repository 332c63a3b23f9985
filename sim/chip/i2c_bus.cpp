// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/i2c_bus.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace asip::sim {
namespace {

// TWCR
constexpr std::uint8_t kFlag = 0x80;
constexpr std::uint8_t kAcknowledge = 0x40;
constexpr std::uint8_t kStart = 0x20;
constexpr std::uint8_t kStop = 0x10;
constexpr std::uint8_t kEnable = 0x04;
constexpr std::uint8_t kWritable = 0x75;
// TWSR
constexpr std::uint8_t kStarted = 0x08, kRestarted = 0x10;
constexpr std::uint8_t kAddressedToWrite = 0x18, kNobodyToWrite = 0x20;
constexpr std::uint8_t kWritten = 0x28, kNotTaken = 0x30;
constexpr std::uint8_t kAddressedToRead = 0x40, kNobodyToRead = 0x48;
constexpr std::uint8_t kRead = 0x50, kReadLast = 0x58;
constexpr std::uint8_t kNothing = 0xf8;

constexpr double kByteBits = 9;
constexpr int kClocksOfAByte = 9;
constexpr double kLookAgainUs = 50;

}  // namespace

I2cBus::I2cBus(AlarmClock& clock, Wiring& wiring, int data_pin, int clock_pin)
    : clock_(clock), wiring_(wiring), data_pin_(data_pin), clock_pin_(clock_pin), alarm_(clock, [this] {
          on_alarm();
      }) {
    for (auto* io = clock.avr().io_port; io != nullptr; io = io->next)
        if (std::strcmp(io->kind, "twi") == 0) port_ = reinterpret_cast<avr_twi_t*>(io);
    if (port_ == nullptr) return;
    for (const auto address : {port_->r_twcr, port_->r_twdr, port_->r_twsr, port_->r_twbr}) {
        auto& io = clock.avr().io[address - kIoBase];
        io.r.c = nullptr;
        io.w.c = address == port_->r_twcr ? write_control : nullptr;
        io.w.param = this;
    }
    wiring.watch(clock_pin, [this](PinState pin) { on_clock_pin(pin); });
    data(port_->r_twsr) = kNothing;
}

void I2cBus::after_reset() {
    if (port_ == nullptr) return;
    alarm_.cancel();
    if (device_ != nullptr && reading_) hold_data(true);
    device_ = nullptr;
    owned_ = reading_ = addressing_ = false;
    step_ = Step::kNone;
    data(port_->r_twsr) = kNothing;
    data(port_->r_twcr) = 0;
}

double I2cBus::bit_cycles() const {
    const unsigned prescale = 1u << 2 * (data(port_->r_twsr) & 3);
    return 16.0 + 2.0 * data(port_->r_twbr) * prescale;
}

bool I2cBus::is_stuck() const {
    return wiring_.is_pulled_low(data_pin_) || wiring_.is_pulled_low(clock_pin_);
}

void I2cBus::hold_data(bool on) {
    clocks_to_release_ = on ? kClocksOfAByte : 0;
    if (on)
        wiring_.drive(data_pin_, false);
    else
        wiring_.release(data_pin_);
}

void I2cBus::on_clock_pin(PinState pin) {
    if (clocks_to_release_ > 0 && pin.high && --clocks_to_release_ == 0) hold_data(false);
}

I2cDevice* I2cBus::find(std::uint8_t address) {
    const auto found = std::find_if(devices_.begin(), devices_.end(), [&](const I2cDevice* device) {
        return device->address() == address && device->is_there();
    });
    return found == devices_.end() ? nullptr : *found;
}

void I2cBus::write_control(avr_t*, avr_io_addr_t, std::uint8_t value, void* param) {
    static_cast<I2cBus*>(param)->control(value);
}

void I2cBus::control(std::uint8_t value) {
    auto& control = data(port_->r_twcr);
    const bool flag_stays = (control & kFlag) != 0 && (value & kFlag) == 0;
    control = static_cast<std::uint8_t>((value & kWritable) | (flag_stays ? kFlag : 0));
    if ((value & kEnable) == 0) {
        alarm_.cancel();
        if (device_ != nullptr && reading_) hold_data(true);
        device_ = nullptr;
        owned_ = reading_ = false;
        step_ = Step::kNone;
        data(port_->r_twsr) = static_cast<std::uint8_t>(kNothing | (data(port_->r_twsr) & 3));
        return;
    }
    if (flag_stays) {
        avr_raise_interrupt(&clock_.avr(), &port_->twi);
        return;
    }
    if (step_ == Step::kStop && (value & kStart) != 0) start_follows_ = true;
    if ((value & kFlag) == 0 || step_ != Step::kNone) return;
    avr_clear_interrupt(&clock_.avr(), &port_->twi);
    if ((value & kStop) != 0 && owned_) {
        start_follows_ = (value & kStart) != 0;
        begin(Step::kStop, 1);
    } else if ((value & kStart) != 0) {
        begin(Step::kStart, 1);
    } else if (owned_) {
        begin(addressing_ ? Step::kAddress : reading_ ? Step::kRead : Step::kWrite, kByteBits);
    }
}

void I2cBus::begin(Step step, double bits) {
    step_ = step;
    alarm_.at(clock_.cycle() + static_cast<std::uint64_t>(bits * bit_cycles()));
}

void I2cBus::on_alarm() {
    // The chip waits for a bus that a device holds low, for ever.
    if (is_stuck())
        return alarm_.at(clock_.cycle() +
                         static_cast<std::uint64_t>(kLookAgainUs * clock_.avr().frequency / 1e6));
    switch (std::exchange(step_, Step::kNone)) {
        case Step::kStart:
            return finish_start();
        case Step::kAddress:
            return finish_address();
        case Step::kWrite:
            return finish_write();
        case Step::kRead:
            return finish_read();
        case Step::kStop:
            return finish_stop();
        case Step::kNone:
            break;
    }
}

void I2cBus::finish_start() {
    const bool again = std::exchange(owned_, true);
    addressing_ = true;
    reading_ = false;
    report(again ? kRestarted : kStarted);
}

void I2cBus::finish_address() {
    const auto byte = data(port_->r_twdr);
    addressing_ = false;
    reading_ = (byte & 1) != 0;
    device_ = find(byte >> 1);
    if (reading_ && device_ != nullptr && !device_->is_ready_to_read()) device_ = nullptr;
    if (device_ != nullptr) device_->started(reading_);
    if (reading_)
        report(device_ != nullptr ? kAddressedToRead : kNobodyToRead);
    else
        report(device_ != nullptr ? kAddressedToWrite : kNobodyToWrite);
}

void I2cBus::finish_write() {
    const bool taken = device_ != nullptr && device_->is_there() && device_->write(data(port_->r_twdr));
    report(taken ? kWritten : kNotTaken);
}

void I2cBus::finish_read() {
    const bool there = device_ != nullptr && device_->is_there();
    data(port_->r_twdr) = there ? device_->read() : 0xff;
    const bool more = (data(port_->r_twcr) & kAcknowledge) != 0;
    if (!more) device_ = nullptr;
    report(more ? kRead : kReadLast);
}

void I2cBus::finish_stop() {
    // Behind a byte that was acknowledged the device sends the next one: its 0 keeps SDA low.
    if (device_ != nullptr && reading_ && device_->read() < 0x80) hold_data(true);
    device_ = nullptr;
    owned_ = reading_ = false;
    auto& control = data(port_->r_twcr);
    control = static_cast<std::uint8_t>(control & ~kStop);
    if (std::exchange(start_follows_, false)) begin(Step::kStart, 1);
}

void I2cBus::report(std::uint8_t status) {
    data(port_->r_twsr) = static_cast<std::uint8_t>(status | (data(port_->r_twsr) & 3));
    data(port_->r_twcr) |= kFlag;
    avr_raise_interrupt(&clock_.avr(), &port_->twi);
}

}  // namespace asip::sim
