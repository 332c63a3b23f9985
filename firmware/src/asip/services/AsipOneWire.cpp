// SPDX-License-Identifier: Apache-2.0
#include "AsipOneWire.h"

#ifdef ARDUINO

#include "asip/Hex.h"

namespace asip {

FlashText OneWire::name() const {
    return ASIP_NAME("OneWire");
}

void OneWire::begin() {
    bus_.begin(*this);
    finish();
}

Error OneWire::processRequest(Request& request) {
    const char tag = request.tag();
    outCount_ = inCount_ = left_ = branch_ = 0;
    if (tag == 'S') {
        left_ = static_cast<uint8_t>(request.number(255));
    } else if (tag == 'T' || tag == 't') {
        inCount_ = static_cast<uint8_t>(request.number(kMaxBytes));
        if (!request.good() || !readHex(request.text(), bytes_, kMaxBytes, outCount_))
            return Error::kBadArgument;
    } else if (tag != 'R') {
        return Error::kUnknownRequest;
    }
    if (!request.complete()) return Error::kBadArgument;
    if (!bus_.isAvailable()) return Error::kDeviceNotAvailable;
    tag_ = tag;
    isStarted_ = false;
    result_ = OneWireBus::kBusy;
    board.setBusy(*this, true);
    return Error::kNone;
}

bool OneWire::start() {
    if (tag_ == 'S') return bus_.search(bytes_, branch_);
    return bus_.start(bytes_, outCount_, inCount_, tag_ != 't');
}

void OneWire::poll() {
    if (tag_ == 0) return;
    if (result_ != OneWireBus::kBusy) {
        if (out.hasRoom()) answer();
        return;
    }
    if (!isStarted_) {
        isStarted_ = start();
        return;
    }
    result_ = bus_.finish();
    if (tag_ != 'S' || result_ != OneWireBus::kDone || left_ == 0) return;
    branch_ = bus_.branch();
    if (branch_ == 0) {
        result_ = OneWireBus::kNobody;  // that was the last
        return;
    }
    --left_;
    isStarted_ = false;
    result_ = OneWireBus::kBusy;
}

void OneWire::answer() {
    const bool isAnswer =
        tag_ == 'R' ? result_ != OneWireBus::kShorted
                    : result_ == OneWireBus::kDone || (tag_ == 'S' && result_ == OneWireBus::kNobody);
    if (isAnswer) {
        out.answer(id(), tag_);
        answerBytes();
        out.end();
    } else {
        out.error(id(), tag_, Error::kDeviceNotAvailable);
    }
    finish();
}

void OneWire::answerBytes() {
    if (tag_ == 'R') return out.number(result_ == OneWireBus::kDone);
    if (result_ != OneWireBus::kDone) return;
    if (tag_ == 'S') {
        writeHex(bytes_ + 1, 8);
    } else {
        writeHex(bytes_, inCount_);
    }
}

void OneWire::finish() {
    tag_ = 0;
    board.setBusy(*this, false);
}

}  // namespace asip

#endif
