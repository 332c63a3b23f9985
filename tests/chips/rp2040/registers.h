// SPDX-License-Identifier: Apache-2.0
// Registers of the RP2040, by its data sheet.
#pragma once

#include <stdint.h>

namespace rp2040 {

inline volatile uint32_t& at(uint32_t address) {
    return *reinterpret_cast<volatile uint32_t*>(address);
}
// Each register has aliases that set and clear the bits written there.
inline void setBits(uint32_t address, uint32_t bits) {
    at(address + 0x2000) = bits;
}
inline void clearBits(uint32_t address, uint32_t bits) {
    at(address + 0x3000) = bits;
}

constexpr uint32_t kSsi = 0x18000000;
constexpr uint32_t kClocks = 0x40008000, kResets = 0x4000c000, kIoBank = 0x40014000, kIoQspi = 0x40018000;
constexpr uint32_t kPads = 0x4001c000, kCrystal = 0x40024000, kPllUsb = 0x4002c000, kUart0 = 0x40034000;
constexpr uint32_t kI2c0 = 0x40044000, kAdc = 0x4004c000, kPwm = 0x40050000, kTimer = 0x40054000,
                   kWatchdog = 0x40058000;
constexpr uint32_t kSio = 0xd0000000, kInterruptEnable = 0xe000e100;

// The chip runs by its crystal. The UART has 48 MHz, which gives 1,000,000 baud exactly.
constexpr uint32_t kCrystalHertz = 12000000, kUartHertz = 48000000;

enum Interrupt { kTimerIrq0 = 0, kTimerIrq1 = 1, kIoIrq = 13, kUart0Irq = 20 };
enum Function { kFunctionUart = 2, kFunctionI2c = 3, kFunctionPwm = 4, kFunctionSio = 5, kFunctionNone = 31 };

inline void enableInterrupt(Interrupt number) {
    at(kInterruptEnable) = 1u << number;
}

// The control register of the GPIO `pin`.
inline uint32_t control(uint8_t pin) {
    return kIoBank + 8u * pin + 4;
}
inline uint32_t pad(uint8_t pin) {
    return kPads + 4 + 4u * pin;
}
constexpr uint32_t kPullDown = 1u << 2, kPullUp = 1u << 3, kInputEnable = 1u << 6, kOutputDisable = 1u << 7;

void onTimer0();
void onTimer1();
void onPins();
void onUart();
void beginPins();

}  // namespace rp2040
