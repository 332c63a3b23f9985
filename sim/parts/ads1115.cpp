// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& ads1115_part();

namespace ads1115 {

constexpr double kLow = -0.3, kHigh = 5.5;
constexpr std::array kQuantities{Quantity{"a0", 0, kLow, kHigh}, Quantity{"a1", 0, kLow, kHigh},
                                 Quantity{"a2", 0, kLow, kHigh}, Quantity{"a3", 0, kLow, kHigh}};

// From the data sheet of the ADS1115.
constexpr std::uint8_t kAddress = 0x48;
constexpr std::uint8_t kConversion = 0, kConfig = 1;
constexpr std::uint16_t kDefault = 0x8583, kStart = 0x8000, kSingleShot = 0x0100;
constexpr std::array<double, 8> kFullScale{6.144, 4.096, 2.048, 1.024, 0.512, 0.256, 0.256, 0.256};
constexpr std::array<double, 8> kPerSecond{8, 16, 32, 64, 128, 250, 475, 860};

/// Four voltages in 16 bits. A measurement takes its time; until it is over the one before is read.
class Ads1115 final : public I2cChip {
  public:
    Ads1115(std::string name, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), ads1115_part(), kAddress, kQuantities, std::move(values), context) {}

    void started(bool reading) override {
        byte_ = 0;
        pointed_ = reading;
    }
    bool write(std::uint8_t byte) override {
        if (!pointed_) {
            pointer_ = byte & 3;
            pointed_ = true;
        } else if (byte_++ == 0) {
            high_ = byte;
        } else if (pointer_ == kConfig) {
            configure(static_cast<std::uint16_t>(high_ << 8 | byte));
        } else {
            thresholds_[pointer_ & 1] = static_cast<std::uint16_t>(high_ << 8 | byte);
        }
        return true;
    }
    std::uint8_t read() override {
        if (byte_ % 2 == 0) word_ = word();
        return static_cast<std::uint8_t>(byte_++ % 2 == 0 ? word_ >> 8 : word_);
    }

  private:
    std::uint8_t read_register(std::uint8_t) override { return 0; }
    void write_register(std::uint8_t, std::uint8_t) override {}
    void power_on() override {
        config_ = kDefault;
        result_ = next_ = 0;
        ready_at_ = 0;
        pointer_ = 0;
        thresholds_ = {0x8000, 0x7fff};
    }

    void configure(std::uint16_t config) {
        config_ = config & 0x7fff;
        if ((config & kSingleShot) != 0 && (config & kStart) == 0) return;
        next_ = measure();
        ready_at_ = context().clock.cycle() +
                    static_cast<std::uint64_t>(1e6 / kPerSecond[config >> 5 & 7] * context().cycles_per_us);
    }

    std::uint16_t word() {
        const bool ready = context().clock.cycle() >= ready_at_;
        if (ready) result_ = (config_ & kSingleShot) != 0 ? next_ : measure();
        if (pointer_ == kConversion) return result_;
        if (pointer_ == kConfig) return static_cast<std::uint16_t>(config_ | (ready ? kStart : 0));
        return thresholds_[pointer_ & 1];
    }

    std::uint16_t measure() const {
        const unsigned inputs = config_ >> 12 & 7;
        constexpr std::array<std::array<std::size_t, 2>, 4> kPairs{{{0, 1}, {0, 3}, {1, 3}, {2, 3}}};
        const double volts =
            inputs >= 4 ? value(inputs - 4) : value(kPairs[inputs][0]) - value(kPairs[inputs][1]);
        const double counts = std::round(volts / kFullScale[config_ >> 9 & 7] * 32768);
        return static_cast<std::uint16_t>(static_cast<int>(std::clamp(counts, -32768.0, 32767.0)));
    }

    std::uint16_t config_ = kDefault;
    std::uint16_t result_ = 0, next_ = 0, word_ = 0;
    std::array<std::uint16_t, 2> thresholds_{0x8000, 0x7fff};
    std::uint64_t ready_at_ = 0;
    std::uint8_t pointer_ = 0, high_ = 0;
    unsigned byte_ = 0;
    bool pointed_ = false;
};

PartPlan read_ads1115(PartReader& reader) {
    return read_i2c_chip<Ads1115>(reader, kQuantities);
}

}  // namespace ads1115

const PartKind& ads1115_part() {
    static constexpr PartKind kind{"ads1115", I2cChip::kVerbs, ads1115::read_ads1115};
    return kind;
}

}  // namespace asip::sim
