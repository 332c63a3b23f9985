// SPDX-License-Identifier: Apache-2.0
// How an RP2040 comes to run the sketch: vectors, clocks. The image has no second-stage boot loader (the 256
// bytes before its vectors are empty), so a real Pico does not start it: it is for the emulator.
#include "core/runtime.h"
#include "registers.h"

using namespace rp2040;

extern "C" {
extern uint32_t stackTop[];
void reset() {
    startProgram();
}
void fault() {
    stopForGood();
}
}

typedef void (*Handler)();
static constexpr unsigned kOfTheCore = 15, kOfTheChip = 26;
struct Vectors {
    uint32_t* stack;
    Handler handlers[kOfTheCore + kOfTheChip];
};

static constexpr Vectors makeVectors() {
    Vectors all = {stackTop, {}};
    for (Handler& handler : all.handlers)
        handler = fault;
    all.handlers[0] = reset;
    all.handlers[kOfTheCore + kTimerIrq0] = onTimer0;
    all.handlers[kOfTheCore + kTimerIrq1] = onTimer1;
    all.handlers[kOfTheCore + kIoIrq] = onPins;
    all.handlers[kOfTheCore + kUart0Irq] = onUart;
    return all;
}

__attribute__((section(".vectors"), used)) extern constexpr Vectors vectors = makeVectors();

static void startClocks() {
    at(kCrystal + 0x0c) = 47;                     // start-up delay: 1 ms
    at(kCrystal) = 0xfabu << 12 | 0xaa0;          // enabled, 1 to 15 MHz
    while ((at(kCrystal + 4) & 1u << 31) == 0) {  // until it is stable
    }
    at(kClocks + 0x3c) = 0;  // the system by the reference clock
    at(kClocks + 0x30) = 2;  // and that by the crystal
    while ((at(kClocks + 0x38) & 1u << 2) == 0) {
    }
    at(kWatchdog + 0x2c) = 1u << 9 | 12;  // the timer's tick: a microsecond

    // 12 MHz * 40 = 480 MHz, divided by 5 and by 2.
    at(kPllUsb) = 1;
    at(kPllUsb + 8) = 40;
    clearBits(kPllUsb + 4, 1u << 0 | 1u << 5);  // on, and its oscillator
    while ((at(kPllUsb) & 1u << 31) == 0) {
    }
    at(kPllUsb + 0x0c) = 5u << 16 | 2u << 12;
    clearBits(kPllUsb + 4, 1u << 3);          // and its dividers
    at(kClocks + 0x48) = 1u << 11 | 2u << 5;  // the peripherals by it
    at(kClocks + 0x60) = 1u << 11;            // the converter, too
}

void startChip() {
    // Out of reset: converter, I2C, pins and their pads, PLL, PWM, timer, UART.
    constexpr uint32_t kUsed =
        1u << 0 | 1u << 3 | 1u << 5 | 1u << 8 | 1u << 13 | 1u << 14 | 1u << 21 | 1u << 22;
    clearBits(kResets, kUsed);
    while ((at(kResets + 8) & kUsed) != kUsed) {
    }
    startClocks();
    beginPins();
}
