// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& mpu6050_part();

namespace {

constexpr double kMin = -32768, kMax = 32767;
constexpr std::array kQuantities{Quantity{"ax", 0, kMin, kMax},     Quantity{"ay", 0, kMin, kMax},
                                 Quantity{"az", 16384, kMin, kMax}, Quantity{"gx", 0, kMin, kMax},
                                 Quantity{"gy", 0, kMin, kMax},     Quantity{"gz", 0, kMin, kMax}};

// Of the register map of the MPU-6000 and MPU-6050.
constexpr std::uint8_t kAddress = 0x68;
constexpr std::uint8_t kAccelerometer = 0x3b, kGyroscope = 0x43;
constexpr std::uint8_t kPower = 0x6b, kWhoAmI = 0x75;
constexpr std::uint8_t kAsleep = 0x40;

/// Accelerometer and gyroscope in one chip, which sleeps until it is woken.
class Mpu6050 final : public I2cChip {
  public:
    Mpu6050(std::string name, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), mpu6050_part(), kAddress, kQuantities, std::move(values), context) {}

  private:
    std::uint8_t read_register(std::uint8_t number) override {
        if (number == kWhoAmI) return kAddress;
        if (number == kPower) return power_;
        if ((power_ & kAsleep) != 0) return 0;
        if (number >= kAccelerometer && number < kAccelerometer + 6)
            return byte_of(static_cast<std::size_t>(number - kAccelerometer) / 2,
                           (number - kAccelerometer) % 2u);
        if (number >= kGyroscope && number < kGyroscope + 6)
            return byte_of(3 + static_cast<std::size_t>(number - kGyroscope) / 2, (number - kGyroscope) % 2u);
        return 0;
    }
    void write_register(std::uint8_t number, std::uint8_t value) override {
        if (number == kPower) power_ = value;
    }
    void power_on() override { power_ = kAsleep; }

    std::uint8_t power_ = kAsleep;
};

PartPlan read_mpu6050(PartReader& reader) {
    return read_i2c_chip<Mpu6050>(reader, kQuantities);
}

}  // namespace

const PartKind& mpu6050_part() {
    static constexpr PartKind kind{"mpu6050", I2cChip::kVerbs, read_mpu6050};
    return kind;
}

}  // namespace asip::sim
