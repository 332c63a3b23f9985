// SPDX-License-Identifier: Apache-2.0
#ifdef __AVR__

#include "AsipSpi.h"

#include "asip/Hardware.h"
#include "asip/Hex.h"

namespace asip {

static constexpr uint8_t kKeepMs = 250, kSlowest = 6;  // a 2^7-th of the clock

FlashText Spi::name() const {
    return ASIP_NAME("SPI");
}

// The chip's own SS has to be an output, or the SPI may cease to be the master.
void Spi::begin() {
    const uint8_t own[] = {SS, MOSI, SCK, MISO};
    isAvailable_ = true;
    isKept_ = false;
    step_ = kIdle;
    for (uint8_t i = 0; i < pinCount_ + sizeof own; ++i) {
        const uint8_t pin = i < pinCount_ ? pins_[i] : own[i - pinCount_];
        if (board.claimPin(pin, *this) != Error::kNone && !board.ownsPin(pin, *this)) isAvailable_ = false;
    }
    board.setBusy(*this, false);
    if (!isAvailable_) return;
    for (uint8_t i = 0; i < pinCount_ + sizeof own - 1; ++i) {
        const uint8_t pin = i < pinCount_ ? pins_[i] : own[i - pinCount_];
        digitalWrite(pin, i <= pinCount_);
        pinMode(pin, OUTPUT);
    }
}

void Spi::choose(bool on) {
    if (chosen_ != kNoPin) digitalWrite(chosen_, !on);
    isKept_ = on;
}

Error Spi::processRequest(Request& request) {
    if (request.tag() != 't') return Error::kUnknownRequest;
    const uint8_t chosen = static_cast<uint8_t>(request.number(255));
    const uint16_t kilohertz = request.number();
    const uint8_t mode = static_cast<uint8_t>(request.number(3));
    const bool keeps = request.number(1) != 0;
    if (!request.good() || kilohertz == 0) return Error::kBadArgument;
    uint8_t bytes[kMaxBytes], count = 0;
    if (!readHex(request.text(), bytes, kMaxBytes, count) || !request.complete()) return Error::kBadArgument;
    bool isKnown = chosen == kNoPin;
    for (uint8_t i = 0; i < pinCount_; ++i)
        isKnown |= pins_[i] == chosen;
    if (!isKnown) return Error::kInvalidPin;
    if (!isAvailable_ || (isKept_ && chosen != chosen_)) return Error::kDeviceNotAvailable;
    uint8_t shift = 0;
    while (shift < kSlowest && F_CPU / 1000 >> (shift + 1) > kilohertz)
        ++shift;
    SPCR = static_cast<uint8_t>(_BV(SPE) | _BV(MSTR) | mode << CPHA | shift >> 1);
    SPSR = shift < kSlowest && !(shift & 1) ? _BV(SPI2X) : 0;
    for (uint8_t i = 0; i < count; ++i)
        bytes_[i] = bytes[i];
    chosen_ = chosen;
    count_ = count;
    at_ = 0;
    keeps_ = keeps;
    choose(true);
    if (count != 0) SPDR = bytes_[0];
    step_ = kUnderWay;
    board.setBusy(*this, true);
    return Error::kNone;
}

void Spi::poll() {
    if (step_ == kIdle) {
        if (isKept_ && static_cast<uint8_t>(hw::milliseconds() - sinceMs_) > kKeepMs) choose(false);
        return;
    }
    if (step_ == kUnderWay) {
        if (at_ < count_) {
            if (!(SPSR & _BV(SPIF))) return;
            bytes_[at_++] = SPDR;
            if (at_ < count_) {
                SPDR = bytes_[at_];
                return;
            }
        }
        if (!keeps_) choose(false);
        step_ = kAnswering;
    }
    if (!out.hasRoom()) return;
    out.answer(id(), 't');
    writeHex(bytes_, count_);
    out.end();
    sinceMs_ = hw::milliseconds();
    step_ = kIdle;
    board.setBusy(*this, false);
}

}  // namespace asip

#endif
