// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& hmc5883l_part();

namespace hmc5883l {

constexpr std::array kQuantities{Quantity{"x", 100, -2048, 2047}, Quantity{"y", 0, -2048, 2047},
                                 Quantity{"z", 0, -2048, 2047}};

// From the data sheet of the HMC5883L.
constexpr std::uint8_t kAddress = 0x1e;
constexpr std::uint8_t kMode = 2, kFirstData = 3, kIdentity = 10;
constexpr std::uint8_t kContinuous = 0, kIdle = 3, kModeBits = 3;
constexpr std::array<std::size_t, 3> kOrder{0, 2, 1};  // x, z, y

/// A compass, which measures once it is in continuous mode.
class Hmc5883l final : public I2cChip {
  public:
    Hmc5883l(std::string name, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), hmc5883l_part(), kAddress, kQuantities, std::move(values), context) {}

  private:
    std::uint8_t read_register(std::uint8_t number) override {
        if (number == kMode) return mode_;
        if (number >= kIdentity && number < kIdentity + 3)
            return static_cast<std::uint8_t>("H43"[number - kIdentity]);
        if (number < kFirstData || number >= kFirstData + 6 || mode_ != kContinuous) return 0;
        const auto byte = static_cast<unsigned>(number - kFirstData);
        return byte_of(kOrder[byte / 2], byte % 2);
    }
    void write_register(std::uint8_t number, std::uint8_t value) override {
        if (number == kMode) mode_ = value & kModeBits;
    }
    void power_on() override { mode_ = kIdle; }

    std::uint8_t mode_ = kIdle;
};

PartPlan read_hmc5883l(PartReader& reader) {
    return read_i2c_chip<Hmc5883l>(reader, kQuantities);
}

}  // namespace hmc5883l

const PartKind& hmc5883l_part() {
    static constexpr PartKind kind{"hmc5883l", I2cChip::kVerbs, hmc5883l::read_hmc5883l};
    return kind;
}

}  // namespace asip::sim
