// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& bh1750_part();

namespace bh1750 {

constexpr std::array kQuantities{Quantity{"lux", 100, 0, 100000}};

// From the data sheet of the BH1750: one byte is an instruction, and a measurement takes this long at most.
constexpr std::uint8_t kLow = 0x23, kHigh = 0x5c;
constexpr std::uint8_t kPowerOn = 1, kReset = 7, kContinuous = 0x10;
constexpr std::uint8_t kTimeHigh = 0x40, kTimeLow = 0x60, kUsualTime = 69;
constexpr double kFineUs = 180000, kCoarseUs = 24000;

/// A sensor of light. A read gives the last measurement, whose time may be set.
class Bh1750 final : public I2cChip {
  public:
    Bh1750(std::string name, std::uint8_t address, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), bh1750_part(), address, kQuantities, std::move(values), context),
          ready_(context.clock, [this] { finish(); }) {}

    void started(bool) override { byte_ = 0; }
    bool write(std::uint8_t byte) override {
        if (byte <= kPowerOn) {
            ready_.cancel();
            on_ = byte == kPowerOn;
        } else if (byte == kReset) {
            if (on_) result_ = 0;
        } else if ((byte & 0xf8) == kTimeHigh) {
            time_ = (time_ & 0x1f) | (byte & 7u) << 5;
        } else if ((byte & 0xe0) == kTimeLow) {
            time_ = (time_ & 0xe0) | (byte & 0x1fu);
        } else if (const auto mode = byte & 3; mode != 2 && (byte & 0xcc) == 0) {
            on_ = true;
            mode_ = byte;
            start();
        }
        return true;
    }
    std::uint8_t read() override { return static_cast<std::uint8_t>(byte_++ == 0 ? result_ >> 8 : result_); }

  private:
    std::uint8_t read_register(std::uint8_t) override { return 0; }
    void write_register(std::uint8_t, std::uint8_t) override {}
    void power_on() override {
        ready_.cancel();
        on_ = false;
        time_ = kUsualTime;
        result_ = 0;
    }

    void start() {
        const double us = ((mode_ & 3) == 3 ? kCoarseUs : kFineUs) * time_ / kUsualTime;
        ready_.at(context().clock.cycle() + static_cast<std::uint64_t>(us * context().cycles_per_us));
    }
    void finish() {
        const double counts = value(0) * 1.2 * time_ / kUsualTime * ((mode_ & 3) == 1 ? 2 : 1);
        result_ = static_cast<std::uint16_t>(std::min(counts, 65535.0));
        if ((mode_ & 0x30) == kContinuous)
            start();
        else
            on_ = false;
    }

    Alarm ready_;
    bool on_ = false;
    std::uint8_t mode_ = 0;
    unsigned time_ = kUsualTime, byte_ = 0;
    std::uint16_t result_ = 0;
};

PartPlan read_bh1750(PartReader& reader) {
    const double address = reader.number("address", kLow, kLow, kHigh);
    if (address != kLow && address != kHigh) reader.fault("address", "must be 35 or 92");
    return read_i2c_chip<Bh1750>(reader, kQuantities, static_cast<std::uint8_t>(address));
}

}  // namespace bh1750

const PartKind& bh1750_part() {
    static constexpr PartKind kind{"bh1750", I2cChip::kVerbs, bh1750::read_bh1750};
    return kind;
}

}  // namespace asip::sim
