// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& mpu6050_part();

namespace mpu6050 {

constexpr double kMin = -32768, kMax = 32767;
constexpr std::array kQuantities{Quantity{"ax", 0, kMin, kMax},     Quantity{"ay", 0, kMin, kMax},
                                 Quantity{"az", 16384, kMin, kMax}, Quantity{"gx", 0, kMin, kMax},
                                 Quantity{"gy", 0, kMin, kMax},     Quantity{"gz", 0, kMin, kMax}};

// From the register map of the MPU-6000 and MPU-6050.
constexpr std::uint8_t kAddress = 0x68;
constexpr std::uint8_t kAccelerometer = 0x3b, kGyroscope = 0x43;
constexpr std::uint8_t kPower = 0x6b, kWhoAmI = 0x75;
constexpr std::uint8_t kAsleep = 0x40, kReset = 0x80;
constexpr std::uint8_t kFirstSetting = 0x19, kLastSetting = 0x1c;  // the ranges among them

/// Accelerometer and gyroscope in one chip, which sleeps until it is woken.
class Mpu6050 final : public I2cChip {
  public:
    Mpu6050(std::string name, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), mpu6050_part(), kAddress, kQuantities, std::move(values), context) {}

  private:
    std::uint8_t read_register(std::uint8_t number) override {
        if (number == kWhoAmI) return kAddress;
        if (number == kPower) return power_;
        if (number >= kFirstSetting && number <= kLastSetting) return settings_[number - kFirstSetting];
        if (number >= kAccelerometer && number < kAccelerometer + 6)
            return measured(0, number - kAccelerometer, settings_[kLastSetting - kFirstSetting]);
        if (number >= kGyroscope && number < kGyroscope + 6)
            return measured(3, number - kGyroscope, settings_[kLastSetting - kFirstSetting - 1]);
        return 0;
    }
    /// In the range that was set: each is twice the one before.
    std::uint8_t measured(std::size_t first, int place, std::uint8_t setting) const {
        if ((power_ & kAsleep) != 0) return 0;
        const auto at = static_cast<std::size_t>(place);
        const auto number =
            static_cast<unsigned>(std::lround(value(first + at / 2) / (1 << (setting >> 3 & 3))));
        return static_cast<std::uint8_t>(at % 2 == 0 ? number >> 8 : number);
    }
    void write_register(std::uint8_t number, std::uint8_t value) override {
        if (number == kPower && (value & kReset) != 0)
            power_on();
        else if (number == kPower)
            power_ = value;
        else if (number >= kFirstSetting && number <= kLastSetting)
            settings_[number - kFirstSetting] = value;
    }
    void power_on() override {
        power_ = kAsleep;
        settings_ = {};
    }

    std::uint8_t power_ = kAsleep;
    std::array<std::uint8_t, kLastSetting - kFirstSetting + 1> settings_{};
};

PartPlan read_mpu6050(PartReader& reader) {
    return read_i2c_chip<Mpu6050>(reader, kQuantities);
}

}  // namespace mpu6050

const PartKind& mpu6050_part() {
    static constexpr PartKind kind{"mpu6050", I2cChip::kVerbs, mpu6050::read_mpu6050};
    return kind;
}

}  // namespace asip::sim
