// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>

#include "FakeHardware.h"
#include "asip/Config.h"
#include "asip/Line.h"

namespace asip {
namespace hw {

Fake fake;

void reset_fake() {
    fake = Fake{};
    fake.eeprom.fill(0xFF);
    fake.duty.fill(-1);
}

// Each access is checked: what the core asks for must exist.
static std::uint8_t checked(std::uint8_t pin) {
    if (pin >= kPins) std::abort();
    return pin;
}

static void report(std::uint8_t pin, Fake::Set what, int value) {
    if (fake.on_set) fake.on_set(pin, what, value);
}

static void set_mode(std::uint8_t pin, FakeMode mode) {
    fake.modes[checked(pin)] = mode;
    report(pin, Fake::Set::kMode, static_cast<int>(mode));
}

FlashText chipName() {
    return F("ATmega328P");
}

// The first pin of a port, and the first one behind it. Port 4 has eight, port 3 the analog ones.
static unsigned first_of(std::uint8_t port) {
    return port == 4 ? 0 : port == 2 ? std::min<unsigned>(8, kFirstAnalogPin) : kFirstAnalogPin;
}
static unsigned end_of(std::uint8_t port) {
    return port == 4 ? first_of(2) : port == 2 ? kFirstAnalogPin : kPins;
}

std::uint8_t portOf(std::uint8_t pin) {
    return checked(pin) >= kFirstAnalogPin ? 3 : pin < 8 ? 4 : 2;
}

std::uint8_t maskOf(std::uint8_t pin) {
    return static_cast<std::uint8_t>(1 << (pin - first_of(portOf(pin))));
}

// Called in each pass for each port: fuzzing is mostly this.
std::uint8_t readPort(std::uint8_t port) {
    if (port < kFirstPort || port > kLastPort) std::abort();
    const unsigned first = first_of(port);
    unsigned levels = 0;
    for (unsigned pin = first; pin < end_of(port); ++pin)
        levels |= static_cast<unsigned>(fake.levels[pin]) << (pin - first);
    return static_cast<std::uint8_t>(levels);
}

bool hasPwm(std::uint8_t pin) {
    return pin == 3 || pin == 5 || pin == 6 || (checked(pin) >= 9 && pin <= 11);
}
bool isAnalog(std::uint8_t pin) {
    return checked(pin) >= kFirstAnalogPin;
}
bool isAlias(std::uint8_t) {
    return false;
}
void setInput(std::uint8_t pin) {
    set_mode(pin, FakeMode::kInput);
}
void setPullUp(std::uint8_t pin) {
    set_mode(pin, FakeMode::kPullUp);
    fake.levels[pin] = true;
}
void setOutput(std::uint8_t pin) {
    set_mode(pin, FakeMode::kOutput);
}

void writePin(std::uint8_t pin, bool high) {
    fake.duty[checked(pin)] = -1;
    if (fake.modes[pin] == FakeMode::kOutput) fake.levels[pin] = high;
    report(pin, Fake::Set::kLevel, high);
}

void writePwm(std::uint8_t pin, std::uint8_t duty) {
    fake.duty[checked(pin)] = duty;
    report(pin, Fake::Set::kDuty, duty);
}
std::uint16_t readAnalog(std::uint8_t channel) {
    return fake.analog.at(channel);
}
std::uint8_t milliseconds() {
    return fake.milliseconds;
}
bool eepromReady() {
    return fake.eeprom_ready;
}
std::uint8_t readEeprom(std::uint16_t address) {
    return fake.eeprom.at(address);
}

void writeEeprom(std::uint16_t address, std::uint8_t value) {
    fake.eeprom.at(address) = value;
    ++fake.eeprom_writes;
}

}  // namespace hw

namespace line {

using hw::fake;

void begin() {
    setRate(kDefaultRate);
}

std::int16_t read() {
    if (fake.to_board.empty()) return -1;
    const auto byte = static_cast<std::uint8_t>(fake.to_board.front());
    fake.to_board.erase(0, 1);
    return byte;
}

std::uint8_t room() {
    return static_cast<std::uint8_t>(fake.room);
}

void write(std::uint8_t byte) {
    fake.from_board.push_back(static_cast<char>(byte));
    if (fake.room == 0)
        ++fake.waits;
    else
        --fake.room;
}

bool idle() {
    return fake.idle;
}

void setRate(std::uint16_t hundreds) {
    fake.baud = hundreds * 100u;
    fake.to_board.clear();
}

bool isRate(std::uint16_t hundreds) {
    return hundreds == 576 || hundreds == 1152 || hundreds == 2500 || hundreds == 5000 || hundreds == 10000;
}

bool usesPin(std::uint8_t pin) {
    return pin < 2;
}

}  // namespace line
}  // namespace asip
