// SPDX-License-Identifier: Apache-2.0
#include "Wire.h"

#include "registers.h"

using namespace rp2040;

static constexpr uint32_t kControl = kI2c0, kTarget = kI2c0 + 0x04, kData = kI2c0 + 0x10;
static constexpr uint32_t kHighTicks = kI2c0 + 0x14, kLowTicks = kI2c0 + 0x18;
static constexpr uint32_t kHappened = kI2c0 + 0x34, kClearAbort = kI2c0 + 0x54, kClearStop = kI2c0 + 0x60;
static constexpr uint32_t kEnable = kI2c0 + 0x6c, kStatus = kI2c0 + 0x70;
static constexpr uint32_t kAborted = 1u << 6, kStopped = 1u << 9;                      // of what happened
static constexpr uint32_t kHasRoom = 1u << 1, kIsEmpty = 1u << 2, kHasByte = 1u << 3;  // of the status
static constexpr uint32_t kReadCommand = 1u << 8, kStopCommand = 1u << 9, kRestartCommand = 1u << 10;
static constexpr uint32_t kTimeoutMicroseconds = 25000;
static constexpr size_t kQueue = 16;

static constexpr uint8_t kPins[] = {SDA, SCL};

TwoWire Wire;

// By reading it.
static uint32_t clear(uint32_t address) {
    return at(address);
}

void TwoWire::begin() {
    if (runs_) return;
    for (const uint8_t pin : kPins) {
        at(pad(pin)) = kInputEnable | kPullUp | 1u << 4 | 1u << 1;
        at(control(pin)) = kFunctionI2c;
    }
    at(kEnable) = 0;
    at(kControl) = 1u << 6 | 1u << 5 | 1u << 1 | 1u << 0;  // a master at 100 kHz, which can start again
    at(kHighTicks) = kCrystalHertz / 100000 / 2 - 8;       // the chip adds some
    at(kLowTicks) = kCrystalHertz / 100000 / 2 - 1;
    runs_ = true;
}

void TwoWire::end() {
    at(kEnable) = 0;
    for (const uint8_t pin : kPins)
        at(control(pin)) = kFunctionNone;
    runs_ = false;
}

void TwoWire::address(uint8_t chip) {
    if (isOpen_) return;
    at(kEnable) = 0;
    at(kTarget) = chip;
    at(kEnable) = 1;
}

bool TwoWire::isAborted() {
    return at(kHappened) & kAborted;
}

bool TwoWire::waitFor(uint32_t address, uint32_t bits) {
    const unsigned long since = micros();
    while ((at(address) & bits) == 0) {
        if (isAborted() || micros() - since > kTimeoutMicroseconds) return false;
    }
    return true;
}

// Until the stop is on the bus; an abort makes one, too.
void TwoWire::finish() {
    const unsigned long since = micros();
    while ((at(kHappened) & kStopped) == 0 && micros() - since < kTimeoutMicroseconds) {
    }
    clear(kClearStop);
    clear(kClearAbort);
    isOpen_ = false;
}

void TwoWire::beginTransmission(uint8_t chip) {
    address_ = chip;
    count_ = 0;
}

size_t TwoWire::write(uint8_t byte) {
    if (count_ == kSize) return 0;
    bytes_[count_++] = byte;
    return 1;
}

uint8_t TwoWire::endTransmission(bool stop) {
    address(address_);
    bool good = true;
    for (uint8_t i = 0; good && i < count_; ++i) {
        good = waitFor(kStatus, kHasRoom) && !isAborted();
        if (good) at(kData) = bytes_[i] | (stop && i + 1 == count_ ? kStopCommand : 0);
    }
    if (good && !stop) good = waitFor(kStatus, kIsEmpty) && !isAborted();
    isOpen_ = good && !stop;
    if (isOpen_) return 0;
    if (good) good = waitFor(kHappened, kStopped | kAborted) && !isAborted();
    finish();
    return good ? 0 : 2;
}

size_t TwoWire::requestFrom(uint8_t chip, size_t wanted, bool stop) {
    const bool again = isOpen_;
    address(chip);
    if (wanted > kSize) wanted = kSize;
    count_ = next_ = 0;
    size_t asked = 0;
    const unsigned long since = micros();
    while (count_ < wanted && !isAborted() && micros() - since < kTimeoutMicroseconds) {
        if (asked < wanted && asked - count_ < kQueue && (at(kStatus) & kHasRoom) != 0) {
            at(kData) = kReadCommand | (asked == 0 && again ? kRestartCommand : 0) |
                        (stop && asked + 1 == wanted ? kStopCommand : 0);
            ++asked;
        }
        if ((at(kStatus) & kHasByte) != 0) bytes_[count_++] = static_cast<uint8_t>(at(kData));
    }
    if (stop || count_ < wanted) finish();
    return count_;
}

int TwoWire::read() {
    return next_ < count_ ? bytes_[next_++] : -1;
}
