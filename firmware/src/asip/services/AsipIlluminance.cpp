// SPDX-License-Identifier: Apache-2.0
#define ASIP_LIBRARY_SOURCE
#ifdef ARDUINO

#include "AsipIlluminance.h"

namespace asip {

// From the data sheet of the BH1750. Behind a measurement it sleeps.
static constexpr uint8_t kPowerOn = 0x01, kMeasureOnce = 0x20;
static constexpr uint8_t kMeasureMs = 184;  // 180 at most

FlashText Illuminance::name() const {
    return ASIP_NAME("Illuminance");
}

I2cSensor::Outcome Illuminance::doStep(uint8_t step) {
    switch (step) {
        case 0:
            return transfer(address_, kPowerOn, nullptr, 0, nullptr, 0);
        case 1:
            return transfer(address_, kMeasureOnce, nullptr, 0, nullptr, 0);
        case 2:
            return wait(kMeasureMs);
        default:
            const Outcome outcome = transfer(address_ | I2c::kNoFirst, 0, nullptr, 0, raw_, sizeof raw_);
            return outcome == kNextStep ? kMeasured : outcome;
    }
}

// A count is 1 / 1.2 lux.
void Illuminance::reportValue(uint8_t) {
    out.hundredths(static_cast<int32_t>(static_cast<uint16_t>(raw_[0] << 8 | raw_[1]) * 250UL / 3));
}

}  // namespace asip

#endif
