// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#include "AsipI2cChips.h"

#ifdef ARDUINO

#include "asip/Hex.h"

namespace asip {

// Beside a way to the chip, 0, and from it, I2c::kRead.
static constexpr uint8_t kNowhere = 2, kOver = 3;

FlashText I2cChips::name() const {
    return ASIP_NAME("I2C");
}

void I2cChips::begin() {
    I2c::begin(*this);
    close();
    finish();
}

uint8_t I2cChips::traitsOf(char tag) {
    static const uint8_t kTraits[] PROGMEM = {
        's', kEnds,
        't', kHasAddress | kHasCount | kHasBytes | kEnds,
        'o', kHasNumber | kHasAddress | kHasBytes | kIsSilent,
        'w', kHasNumber | kHasBytes | kIsSilent,
        'r', kHasNumber | kHasCount | kHasMore,
        'e', kHasNumber | kHasCount | kHasBytes | kEnds,
        0,   0,
    };
    const uint8_t* next = kTraits;
    for (;;) {
        const uint8_t of = pgm_read_byte(next++);
        const uint8_t traits = pgm_read_byte(next++);
        if (of == static_cast<uint8_t>(tag) || of == 0) return traits;
    }
}

// What is kept of the transfer that is open changes only once the request is seen to be good.
Error I2cChips::processRequest(Request& request) {
    const char tag = request.tag();
    const uint8_t traits = traitsOf(tag);
    if (traits == 0) return Error::kUnknownRequest;
    const uint8_t number = static_cast<uint8_t>(traits & kHasNumber ? request.number(255) : 0);
    const uint8_t address = static_cast<uint8_t>(traits & kHasAddress ? request.number(127) : kFirst);
    outCount_ = inCount_ = 0;
    if (traits & kHasCount) inCount_ = static_cast<uint8_t>(request.number(kMaxIn));
    more_ = (traits & kHasMore) && request.number(1) != 0 ? I2c::kMore : 0;
    if ((traits & kHasBytes) && !readHex(request.text(), bytes_, kMaxOut, outCount_))
        return Error::kBadArgument;
    if (!request.complete() || ((traits & kHasMore) && inCount_ == 0)) return Error::kBadArgument;
    if (!I2c::isEnabled()) return Error::kI2cNotEnabled;
    const bool goesOn = (traits & (kHasNumber | kHasAddress)) == kHasNumber;
    if (!isOpen_ || !(traits & kHasNumber) || number != number_) {
        if (goesOn) return Error::kWrongMode;
        if (isOpen_) return Error::kDeviceNotAvailable;
    }
    tag_ = tag;
    traits_ = traits;
    isOpen_ = traits & kHasNumber;
    number_ = number;
    if (!goesOn) {
        address_ = address;
        direction_ = kNowhere;
    }
    const bool looks = (traits & kEnds) && direction_ == kNowhere;
    writes_ = outCount_ != 0 || (inCount_ == 0 && looks);
    step_ = kStarting;
    board.setBusy(*this, true);
    if (fault_ != 0 || (!writes_ && inCount_ == 0)) settle();
    return Error::kNone;
}

void I2cChips::poll() {
    switch (step_) {
        case kIdle:
            if (isOpen_ && static_cast<uint8_t>(hw::milliseconds() - sinceMs_) > kKeepMs) close();
            return;
        case kStarting:
            if (start()) step_ = kUnderWay;
            return;
        case kUnderWay:
            return finishPart();
        case kAnswering:
            if (out.hasRoom()) answer();
    }
}

bool I2cChips::start() {
    uint8_t way = writes_ ? 0 : I2c::kRead;
    if (way == direction_) way |= I2c::kGoOn;
    way |= more_;
    if ((traits_ & kEnds) && (!writes_ || inCount_ == 0)) way |= I2c::kStop;
    return I2c::startPart(way, address_, bytes_, writes_ ? outCount_ : inCount_);
}

void I2cChips::finishPart() {
    const I2c::Result result = I2c::finishPart();
    if (result == I2c::kBusy) return;
    const uint8_t fault = result == I2c::kFailed ? I2c::fault() : I2c::kNoFault;
    if (tag_ == 's' && fault <= I2c::kNoAddress) return found(fault == I2c::kNoFault);
    fault_ = fault;
    direction_ = writes_ ? 0 : more_ != 0 ? static_cast<uint8_t>(I2c::kRead) : kOver;
    const bool turns = writes_ && inCount_ != 0 && fault == I2c::kNoFault;
    writes_ = false;
    if (turns) {
        step_ = kStarting;
    } else {
        settle();
    }
}

void I2cChips::found(bool there) {
    uint8_t& byte = bytes_[static_cast<uint8_t>(address_ - kFirst) / 8];
    byte = static_cast<uint8_t>(byte / 2U);
    if (there) {
        byte |= 0x80;
        ++number_;
    }
    step_ = address_++ < kLast ? kStarting : kAnswering;
}

// All of a request is done that concerns the bus, or nothing of it can be.
void I2cChips::settle() {
    if (traits_ & kIsSilent) {
        finish();
    } else {
        step_ = kAnswering;
    }
}

void I2cChips::finish() {
    sinceMs_ = hw::milliseconds();
    step_ = kIdle;
    board.setBusy(*this, false);
}

void I2cChips::answer() {
#ifndef __AVR__
    if (fault_ == 0 && (traits_ & kEnds)) fault_ = I2c::endParts();  // Wire sends a last write only now
#endif
    const uint8_t fault = fault_;
    if (fault != 0) {
        sendFault();
    } else if (tag_ == 's') {
        board.sendList(*this, 's', number_);
    } else {
        out.answer(id(), tag_);
        writeHex(bytes_, inCount_);
        out.end();
    }
    if (fault != 0 || (traits_ & kEnds)) close();
    finish();
}

// As out.error(), with the address: ~J,t,12{ADDRESS_NOT_ACKNOWLEDGED 118}
void I2cChips::sendFault() const {
    static const char kTexts[] PROGMEM =
        "ADDRESS_NOT_ACKNOWLEDGED\0"
        "DATA_NOT_ACKNOWLEDGED\0"
        "BUS_HELD_LOW\0"
        "CLOCK_HELD_LOW\0"
        "TRANSFER_TOO_LONG";
    const char* text = kTexts;
    for (uint8_t skip = 1; skip < fault_; ++skip) {
        while (pgm_read_byte(text++) != 0) {
        }
    }
    out.head('~', id(), tag_);
    out.number(static_cast<uint8_t>(11 + fault_));
    out.character('{');
    out.text(flashText(text));
    out.character(' ');
    out.number(address_);
    out.character('}');
    out.end();
}

void I2cChips::close() {
    I2c::endParts();
    isOpen_ = false;
    fault_ = 0;
    direction_ = kNowhere;
}

// The address of the chip that was found as the `index`-th.
void I2cChips::reportValue(uint8_t index) {
    uint8_t bit = 0;
    for (;; ++bit) {
        if (!(bytes_[bit / 8] & 1 << bit % 8)) continue;
        if (index == 0) break;
        --index;
    }
    out.number(static_cast<uint8_t>(bit + kFirst));
}

}  // namespace asip

#endif
