// SPDX-License-Identifier: Apache-2.0
// An Uno that exists in these variables only, in place of HardwareAvr.h, and its line. Tests set the levels
// of inputs and the time, and look at what was sent.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "asip/Flash.h"

namespace asip {
namespace hw {

#ifdef ASIP_FAKE_FEW_PINS
// Whose answers are short.
constexpr std::uint8_t kPins = 6;
constexpr std::uint8_t kAnalogChannels = 1;
#else
constexpr std::uint8_t kPins = 20;
constexpr std::uint8_t kAnalogChannels = 6;
#endif
constexpr std::uint8_t kFirstAnalogPin = kPins - kAnalogChannels;
constexpr bool kHasAnalogOnlyPins = false;
constexpr std::uint8_t kFirstPort = 2, kLastPort = 4;
constexpr std::uint16_t kEepromEnd = 1023;

enum class FakeMode : std::uint8_t { kUntouched, kInput, kPullUp, kOutput };

struct Fake {
    std::array<bool, kPins> levels{};  // of inputs, from outside; of outputs, as written
    std::array<FakeMode, kPins> modes{};
    std::array<int, kPins> duty{};  // of PWM, -1 when it is off
    std::array<std::uint16_t, kAnalogChannels> analog{};
    std::array<std::uint8_t, kEepromEnd + 1> eeprom{};
    unsigned eeprom_writes = 0;
    bool eeprom_ready = true;
    std::uint8_t milliseconds = 0;

    std::string to_board;    // not read yet
    std::string from_board;  // sent
    std::size_t room = 63;   // what write() takes without waiting
    unsigned waits = 0;      // bytes written beyond the room
    bool idle = true;        // all that was sent is on the wire
    std::uint32_t baud = 0;

    // Called for each pin that the board sets, whatever it was before.
    enum class Set : std::uint8_t { kMode, kLevel, kDuty };
    void (*on_set)(std::uint8_t pin, Set what, int value) = nullptr;
};

// As after power-up: EEPROM erased, pins low.
extern Fake fake;
void reset_fake();

FlashText chipName();
std::uint8_t portOf(std::uint8_t pin);
std::uint8_t maskOf(std::uint8_t pin);
std::uint8_t readPort(std::uint8_t port);
bool hasPwm(std::uint8_t pin);
bool isAnalog(std::uint8_t pin);
bool isAlias(std::uint8_t pin);
inline bool isHidden(std::uint8_t) {
    return false;
}
inline bool isAnalogOnly(std::uint8_t) {
    return false;
}
inline bool isBusPin(std::uint16_t) {
    return false;
}
void setInput(std::uint8_t pin);
void setPullUp(std::uint8_t pin);
void setOutput(std::uint8_t pin);
void writePin(std::uint8_t pin, bool high);
void writePwm(std::uint8_t pin, std::uint8_t duty);
std::uint16_t readAnalog(std::uint8_t channel);
std::uint8_t milliseconds();
bool eepromReady();
std::uint8_t readEeprom(std::uint16_t address);
void writeEeprom(std::uint16_t address, std::uint8_t value);

}  // namespace hw
}  // namespace asip
