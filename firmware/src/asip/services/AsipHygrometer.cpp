// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#ifdef ARDUINO

#include "AsipHygrometer.h"

namespace asip {

// From the data sheet of the SHT3x. A command is two bytes.
static constexpr uint16_t kReset = 0x30A2, kMeasure = 0x2400;  // once, without holding the clock
static constexpr uint8_t kMeasureMs = 16, kResetMs = 2;

FlashText Hygrometer::name() const {
    return ASIP_NAME("Hygrometer");
}

I2cSensor::Outcome Hygrometer::doStep(uint8_t step) {
    const uint16_t sent = step == 0 ? kReset : kMeasure;
    switch (step) {
        case 0:
        case 2:
            raw_[0] = static_cast<uint8_t>(sent);
            return transfer(address_, sent >> 8, raw_, 1, nullptr, 0);
        case 1:
            return wait(kResetMs);
        case 3:
            return wait(kMeasureMs);
        default:
            const Outcome outcome = transfer(address_ | I2c::kNoFirst, 0, nullptr, 0, raw_, sizeof raw_);
            if (outcome != kNextStep) return outcome;
            isDamaged_ = checksum(raw_) != raw_[2] || checksum(raw_ + 3) != raw_[5];
            if (isDamaged_ && damaged_ != 255) ++damaged_;
            return kMeasured;
    }
}

Error Hygrometer::processRequest(Request& request) {
    if (request.tag() != 'E') return I2cSensor::processRequest(request);
    if (!request.complete()) return Error::kBadArgument;
    board.sendList(*this, 'E', 1);
    return Error::kNone;
}

// CRC-8 over two bytes: x^8 + x^5 + x^4 + 1, from 0xFF on.
uint8_t Hygrometer::checksum(const uint8_t* word) {
    uint8_t sum = 0xFF;
    for (uint8_t i = 0; i < 2; ++i) {
        sum ^= word[i];
        for (uint8_t bit = 0; bit < 8; ++bit)
            sum = static_cast<uint8_t>(sum & 0x80 ? sum << 1 ^ 0x31 : sum << 1);
    }
    return sum;
}

void Hygrometer::reportValue(uint8_t index) {
    if (board.listTag() == 'E') return out.number(damaged_);
    if (isDamaged_) return;
    const uint8_t* const word = raw_ + 3 * index;
    const uint32_t raw = static_cast<uint16_t>(word[0] << 8 | word[1]);
    out.hundredths(static_cast<int32_t>((raw * (index == 0 ? 17500 : 10000) + 32767) / 65535) -
                   (index == 0 ? 4500 : 0));
}

}  // namespace asip

#endif
