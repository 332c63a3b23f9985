// SPDX-License-Identifier: Apache-2.0
#include "AsipThermometers.h"

#ifdef ARDUINO
#include <string.h>

#include "asip/Hex.h"

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
    const bool available = bus_.begin(*this);
    setCount(available ? 1 : 0);
    known_ = 0;
    wanted_ = 0;
    hasParasite_ = isStarted_ = false;
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
    wanted_ |= tag == 'S' ? kList : kByRequest;
    return Error::kNone;
}

// What is under way is the answer to this too.
void Thermometers::reportValues() {
    wanted_ |= kByPeriod;
}

bool Thermometers::canMeasure() const {
    return known_ != 0 && !hasParasite_;
}

void Thermometers::reportValue(uint8_t index) {
    const Thermometer& one = all_[index];
    const char tag = board.listTag();
    if (tag == 'E') {
        out.pair(one.damaged, one.silent);
    } else if (tag != 'e') {
        writeHex(one.id, kIdBytes);
    } else if (one.sixteenths != kNoValue) {
        out.shortHundredths(static_cast<int16_t>(one.sixteenths * 6 + one.sixteenths / 4));
    }
}

void Thermometers::turnTo(Task task) {
    task_ = task;
    branch_ = damagedIds_ = 0;
}

void Thermometers::poll() {
    if (task_ >= kSearch) {
        if (!isStarted_) {
            isStarted_ = startTask();
            return;
        }
        const OneWireBus::Result result = bus_.finish();
        if (result != OneWireBus::kBusy) finishTask(result);
    } else if (task_ == kIdle) {
        if (wanted_ != 0) turnTo((wanted_ & kList) || !canMeasure() ? kSearch : kPrepare);
    } else if (task_ == kWait) {
        if (static_cast<uint16_t>(hw::shortMilliseconds() - sinceMs_) <= kMeasureMs) return;
        index_ = 0;
        task_ = kRead;
    } else if (out.hasRoom()) {
        board.sendList(*this, task_ == kReport ? 'e' : 'I', known_);
        task_ = kIdle;
    }
}

// Each thermometer is told the number of the round before it measures, and has to tell it with its value: one
// that lost its power meanwhile shows 85 degrees, or what it measured at another time, and has forgotten the
// number.
bool Thermometers::startTask() {
    if (task_ == kSearch) return bus_.search(bytes_, branch_);
    uint8_t outCount = 2, inCount = 0;
    bytes_[0] = kSkipId;
    if (task_ == kAskPower) {
        bytes_[1] = kHasPower;
        inCount = 1;
    } else if (task_ == kPrepare) {
        bytes_[1] = kWriteAll;
        bytes_[2] = ++round_;
        bytes_[3] = static_cast<uint8_t>(~round_);
        bytes_[4] = kTwelveBits;
        outCount = 5;
    } else if (task_ == kConvert) {
        bytes_[1] = kMeasure;
    } else {
        bytes_[0] = kMatchId;
        memcpy(bytes_ + 1, all_[index_].id, kIdBytes);
        bytes_[9] = kReadAll;
        outCount = 10;
        inCount = 9;
    }
    return bus_.start(bytes_, outCount, inCount);
}

void Thermometers::finishTask(OneWireBus::Result result) {
    const bool done = result == OneWireBus::kDone;
    isStarted_ = false;
    if (task_ == kSearch) {
        branch_ = bus_.branch();
        if (done) found();
        if (!done || branch_ == 0 || damagedIds_ == kMaxDamagedIds) task_ = kAskPower;
    } else if (task_ == kAskPower) {
        hasParasite_ = done && bytes_[0] != 0xFF;
        finishSearch();
    } else if (task_ == kPrepare) {
        task_ = kConvert;
    } else if (task_ == kConvert) {
        sinceMs_ = hw::shortMilliseconds();
        task_ = kWait;
    } else {
        take(done);
        if (++index_ < known_) return;
        wanted_ &= kList;
        task_ = kReport;
    }
}

// Keeps the id that a search found, behind those that are known.
void Thermometers::found() {
    const uint8_t* const id = bytes_ + 1;
    ++damagedIds_;
    if (OneWireBus::checksum(id, kIdBytes) != 0) return;
    damagedIds_ = 0;
    const uint8_t family = id[0];
    if (family != kFamilyB20 && family != kFamilyS20 && family != kFamily22 && family != kFamily25) return;
    Thermometer* one = all_;
    for (uint8_t left = known_; left != 0; --left) {
        if (memcmp(one->id, id, kIdBytes) == 0) return;
        ++one;
    }
    if (known_ == room_) return;
    ++known_;
    memcpy(one->id, id, kIdBytes);
    one->sixteenths = kNoValue;
    one->damaged = one->silent = 0;
}

void Thermometers::finishSearch() {
    if (wanted_ & kList) {
        wanted_ &= static_cast<uint8_t>(~kList);
        task_ = kReportIds;
        return;
    }
    if (!canMeasure()) {
        if (!out.hasRoom()) return;  // comes here again
        if (wanted_ & kByRequest)
            out.error(id(), 'e', hasParasite_ ? Error::kModeUnavailable : Error::kDeviceNotAvailable);
        wanted_ = 0;
    }
    task_ = kIdle;
}

void Thermometers::take(bool done) {
    Thermometer& one = all_[index_];
    one.sixteenths = kNoValue;
    uint8_t* counter = &one.silent;
    if (done) {
        if (OneWireBus::checksum(bytes_, 9) == 0 && bytes_[2] == round_ &&
            bytes_[3] == static_cast<uint8_t>(~round_)) {
            const int16_t raw = static_cast<int16_t>(bytes_[1] << 8 | bytes_[0]);
            one.sixteenths = one.id[0] == kFamilyS20 ? static_cast<int16_t>(raw * 8) : raw;
            return;
        }
        if ((bytes_[4] & bytes_[8]) != 0xFF) counter = &one.damaged;
    }
    if (*counter != 255) ++*counter;
}

}  // namespace asip

#endif
