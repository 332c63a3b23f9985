// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#include "AsipI2cChips.h"

#ifdef ARDUINO

#include "asip/Hex.h"

namespace asip {

static constexpr uint8_t kNowhere = 0, kToChip = 1, kFromChip = 2, kOver = 3;

FlashText I2cChips::name() const {
    return ASIP_NAME("I2C");
}

void I2cChips::begin() {
    I2c::begin(*this);
    close();
    step_ = kIdle;
    board.setBusy(*this, false);
}

Error I2cChips::processRequest(Request& request) {
    const char tag = request.tag();
    const bool opens = tag == 'o', goesOn = tag == 'w' || tag == 'r' || tag == 'e';
    if (tag != 's' && tag != 't' && !opens && !goesOn) return Error::kUnknownRequest;
    const uint8_t number = opens || goesOn ? static_cast<uint8_t>(request.number(255)) : 0;
    const uint8_t address = tag == 't' || opens ? static_cast<uint8_t>(request.number(127)) : address_;
    const bool reads = tag == 't' || tag == 'r' || tag == 'e';
    const uint8_t count = reads ? static_cast<uint8_t>(request.number(kMaxIn)) : 0;
    const bool more = tag == 'r' && request.number(1) != 0;
    uint8_t written = 0;
    if (!request.good() || (tag == 'r' && count == 0)) return Error::kBadArgument;
    if (tag != 's' && tag != 'r' && !readHex(request.text(), bytes_, kMaxOut, written))
        return Error::kBadArgument;
    if (!request.complete()) return Error::kBadArgument;
    if (!I2c::isEnabled()) return Error::kI2cNotEnabled;
    const bool isOwn = isOpen_ && number == number_;
    if (goesOn && !isOwn) return Error::kWrongMode;
    if (!goesOn && isOpen_ && !(opens && isOwn)) return Error::kDeviceNotAvailable;
    tag_ = tag;
    number_ = number;
    address_ = tag == 's' ? kFirst : address;
    outCount_ = written;
    inCount_ = count;
    isMore_ = more;
    isOpen_ = opens || goesOn;
    if (opens || tag == 't') direction_ = kNowhere;
    const bool looks = tag == 't' || tag == 's' || (tag == 'e' && direction_ == kNowhere);
    writes_ = written != 0 || (count == 0 && looks);
    if (tag == 's') {
        for (uint8_t& byte : bytes_)
            byte = 0;
    }
    step_ = kStarting;
    if (fault_ != 0 || (!writes_ && count == 0)) settle();
    board.setBusy(*this, step_ != kIdle);
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
    const uint8_t direction = writes_ ? kToChip : kFromChip;
    uint8_t way = direction == direction_ ? I2c::kGoOn : 0;
    if (!writes_) way |= I2c::kRead;
    if (isMore_) way |= I2c::kMore;
    if (tag_ == 's' || (ends() && (!writes_ || inCount_ == 0))) way |= I2c::kStop;
    return I2c::startPart(way, address_, bytes_, writes_ ? outCount_ : inCount_);
}

void I2cChips::finishPart() {
    const I2c::Result result = I2c::finishPart();
    if (result == I2c::kBusy) return;
    const bool failed = result == I2c::kFailed;
    const uint8_t fault = failed ? I2c::fault() : I2c::kNoFault;
    if (tag_ == 's' && (!failed || fault == I2c::kNoAddress)) return found(!failed);
    fault_ = fault;
    direction_ = writes_ ? kToChip : isMore_ ? kFromChip : kOver;
    const bool turns = writes_ && inCount_ != 0 && !failed;
    writes_ = false;
    if (turns) {
        step_ = kStarting;
    } else {
        settle();
    }
}

void I2cChips::found(bool there) {
    const uint8_t bit = static_cast<uint8_t>(address_ - kFirst);
    if (there) {
        bytes_[bit / 8] |= static_cast<uint8_t>(1 << bit % 8);
        ++inCount_;
    }
    step_ = address_++ < kLast ? kStarting : kAnswering;
}

// All of a request is done that concerns the bus, or nothing of it can be.
void I2cChips::settle() {
    sinceMs_ = hw::milliseconds();
    if (tag_ != 'o' && tag_ != 'w') {
        step_ = kAnswering;
        return;
    }
    step_ = kIdle;
    board.setBusy(*this, false);
}

void I2cChips::answer() {
#ifndef __AVR__
    if (fault_ == 0 && ends()) fault_ = I2c::endParts();  // Wire sends a last write only now
#endif
    const uint8_t fault = fault_;
    if (fault != 0) {
        sendFault();
    } else if (tag_ == 's') {
        board.sendList(*this, 's', inCount_);
    } else {
        out.answer(id(), tag_);
        for (uint8_t i = 0; i < inCount_; ++i)
            writeHex(bytes_[i]);
        out.end();
    }
    if (fault != 0 || ends()) close();
    sinceMs_ = hw::milliseconds();
    step_ = kIdle;
    board.setBusy(*this, false);
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
    out.character('~');
    out.character(id());
    out.character(',');
    out.character(tag_);
    out.character(',');
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
