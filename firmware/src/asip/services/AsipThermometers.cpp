// SPDX-License-Identifier: Apache-2.0
#include "AsipThermometers.h"

#ifdef ARDUINO

namespace asip {

// From the data sheet of the DS18B20.
static constexpr uint8_t kSkipId = 0xCC, kMatchId = 0x55;
static constexpr uint8_t kMeasure = 0x44, kReadAll = 0xBE, kWriteAll = 0x4E, kHasPower = 0xB4;
static constexpr uint8_t kTwelveBits = 0x7F;
static constexpr uint16_t kMeasureMs = 750;
static constexpr uint8_t kFamilyB20 = 0x28, kFamilyS20 = 0x10, kFamily22 = 0x22, kFamily25 = 0x3B;
// In a row. A line that rises too late shows a branch at each bit, and a search would find ids without end.
static constexpr uint8_t kMaxDamagedIds = 3;
static constexpr int16_t kNoValue = -32768;

FlashText Thermometers::name() const {
    return ASIP_NAME("Thermometers");
}

// A is the core's, whether any is there or not: reports begin once one is found.
void Thermometers::begin() {
    bus_.begin(*this);
    const bool available = bus_.isAvailable();
    setCount(available ? 1 : 0);
    known_ = 0;
    isAsked_ = isDue_ = isListing_ = hasParasite_ = false;
    lastMs_ = hw::milliseconds();
    turnTo(available ? kSearch : kIdle);
}

Error Thermometers::processRequest(Request& request) {
    const char tag = request.tag();
    if (tag == 'A') {
        request.number();
    } else if (tag != 'M' && tag != 'I' && tag != 'E' && tag != 'S') {
        return Error::kUnknownRequest;
    }
    if (!request.complete()) return Error::kBadArgument;
    if (tag == 'I' || tag == 'E') {
        board.sendList(*this, tag, known_);
        return Error::kNone;
    }
    if (count() == 0) return Error::kDeviceNotAvailable;
    (tag == 'S' ? isListing_ : isAsked_) = true;
    return Error::kNone;
}

// What is under way is the answer to this too.
void Thermometers::reportValues() {
    isDue_ = true;
}

bool Thermometers::canMeasure() const {
    return known_ != 0 && !hasParasite_;
}

void Thermometers::reportValue(uint8_t index) {
    const Thermometer& one = all_[index];
    const char tag = board.listTag();
    if (tag == 'E') {
        out.number(one.damaged);
        out.character(':');
        return out.number(one.silent);
    }
    if (tag == 'e') {
        if (one.sixteenths != kNoValue) out.hundredths(one.sixteenths * 25L / 4);
        return;
    }
    for (uint8_t i = 0; i <= kIdBytes; ++i) {
        const uint8_t byte = i < kIdBytes ? one.id[i] : OneWireBus::checksum(one.id, kIdBytes);
        if (byte < 16) out.character('0');
        out.hexByte(byte);
    }
}

void Thermometers::turnTo(Task task) {
    task_ = task;
    isStarted_ = false;
    waitedMs_ = 0;
    branch_ = damagedIds_ = 0;
}

void Thermometers::poll() {
    const uint8_t now = hw::milliseconds();
    waitedMs_ = static_cast<uint16_t>(waitedMs_ + static_cast<uint8_t>(now - lastMs_));
    lastMs_ = now;
    switch (task_) {
        case kIdle:
            if (isListing_ || isAsked_ || isDue_) turnTo(isListing_ || !canMeasure() ? kSearch : kPrepare);
            return;
        case kWait:
            if (waitedMs_ > kMeasureMs) nextThermometer(0);
            return;
        case kReport:
        case kReportIds:
            if (!out.hasRoom()) return;
            board.sendList(*this, task_ == kReport ? 'e' : 'I', known_);
            return turnTo(kIdle);
        default:
            break;
    }
    if (!isStarted_) {
        isStarted_ = startTask();
        return;
    }
    const OneWireBus::Result result = bus_.finish();
    if (result != OneWireBus::kBusy) finishTask(result);
}

// Each thermometer is told the number of the round before it measures, and has to tell it with its value: one
// that lost its power meanwhile shows 85 degrees, or what it measured at another time, and has forgotten the
// number.
bool Thermometers::startTask() {
    if (task_ == kSearch) return bus_.search(bytes_, branch_);
    bytes_[0] = kSkipId;
    switch (task_) {
        case kAskPower:
            bytes_[1] = kHasPower;
            return bus_.start(bytes_, 2, 1);
        case kPrepare:
            bytes_[1] = kWriteAll;
            bytes_[2] = ++round_;
            bytes_[3] = static_cast<uint8_t>(~round_);
            bytes_[4] = kTwelveBits;
            return bus_.start(bytes_, 5, 0);
        case kConvert:
            bytes_[1] = kMeasure;
            return bus_.start(bytes_, 2, 0);
        default:
            bytes_[0] = kMatchId;
            for (uint8_t i = 0; i < kIdBytes; ++i)
                bytes_[i + 1] = all_[index_].id[i];
            bytes_[8] = OneWireBus::checksum(bytes_ + 1, kIdBytes);
            bytes_[9] = kReadAll;
            return bus_.start(bytes_, 10, 9);
    }
}

void Thermometers::finishTask(OneWireBus::Result result) {
    const bool done = result == OneWireBus::kDone;
    isStarted_ = false;
    switch (task_) {
        case kSearch:
            branch_ = bus_.branch();
            if (done) found();
            if (!done || branch_ == 0 || damagedIds_ == kMaxDamagedIds) turnTo(kAskPower);
            return;
        case kAskPower:
            hasParasite_ = done && bytes_[0] != 0xFF;
            return finishSearch();
        case kPrepare:
            return turnTo(kConvert);
        case kConvert:
            return turnTo(kWait);
        default:
            take(result);
            return nextThermometer(static_cast<uint8_t>(index_ + 1));
    }
}

// Keeps the id that a search found, behind those that are known.
void Thermometers::found() {
    if (OneWireBus::checksum(bytes_, kIdBytes + 1) != 0) {
        ++damagedIds_;
        return;
    }
    damagedIds_ = 0;
    const uint8_t family = bytes_[0];
    if (family != kFamilyB20 && family != kFamilyS20 && family != kFamily22 && family != kFamily25) return;
    for (uint8_t at = 0; at < known_; ++at) {
        uint8_t same = 0;
        while (same < kIdBytes && all_[at].id[same] == bytes_[same])
            ++same;
        if (same == kIdBytes) return;
    }
    if (known_ == room_) return;
    Thermometer& one = all_[known_++];
    for (uint8_t i = 0; i < kIdBytes; ++i)
        one.id[i] = bytes_[i];
    one.sixteenths = kNoValue;
    one.damaged = one.silent = 0;
}

void Thermometers::finishSearch() {
    if (isListing_) {
        isListing_ = false;
        return turnTo(kReportIds);
    }
    if (!canMeasure()) {
        if (!out.hasRoom()) return;  // comes here again
        if (isAsked_)
            out.error(id(), 'e', hasParasite_ ? Error::kModeUnavailable : Error::kDeviceNotAvailable);
        isAsked_ = isDue_ = false;
    }
    turnTo(kIdle);
}

void Thermometers::nextThermometer(uint8_t index) {
    index_ = index;
    if (index < known_) return turnTo(kRead);
    isAsked_ = isDue_ = false;
    turnTo(kReport);
}

void Thermometers::take(OneWireBus::Result result) {
    Thermometer& one = all_[index_];
    one.sixteenths = kNoValue;
    uint8_t& counter =
        result == OneWireBus::kDone && (bytes_[4] & bytes_[8]) != 0xFF ? one.damaged : one.silent;
    if (result == OneWireBus::kDone && OneWireBus::checksum(bytes_, 9) == 0 && bytes_[2] == round_ &&
        bytes_[3] == static_cast<uint8_t>(~round_)) {
        const int16_t raw = static_cast<int16_t>(bytes_[1] << 8 | bytes_[0]);
        one.sixteenths = one.id[0] == kFamilyS20 ? static_cast<int16_t>(raw * 8) : raw;
    } else if (counter != 255) {
        ++counter;
    }
}

}  // namespace asip

#endif
