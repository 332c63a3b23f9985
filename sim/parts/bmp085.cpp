// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& bmp085_part();

namespace bmp085 {

constexpr std::array kQuantities{Quantity{"pressure", 1013.25, 300, 1100},
                                 Quantity{"temperature", 20, -40, 85}};

// From the data sheet of the BMP085, whose example of calibration words this chip has.
constexpr std::uint8_t kAddress = 0x77;
constexpr std::uint8_t kChip = 0xd0;  // and its version
constexpr std::uint8_t kFirstWord = 0xaa, kControl = 0xf4, kResult = 0xf6;
constexpr std::uint8_t kMeasureTemperature = 0x2e, kMeasurePressure = 0x34;
constexpr double kTemperatureUs = 4500;
constexpr std::array<double, 4> kPressureUs{4500, 7500, 13500, 25500};
constexpr std::array<int, 11> kWords{408, -72, -14383, 32741, 32757, 23153, 6190, 4, -32768, -8711, 2868};

/// Tenths of a degree and pascals of raw values, with the oversampling `oss`.
struct Converted {
    long b5;
    long temperature;
};
Converted temperature_of(long raw) {
    const auto [ac1, ac2, ac3, ac4, ac5, ac6, b1, b2, mb, mc, md] = kWords;
    const long x1 = (raw - ac6) * ac5 >> 15;
    const long b5 = x1 + mc * 2048L / (x1 + md);
    return {b5, (b5 + 8) >> 4};
}
long pressure_of(long raw, long b5, int oss) {
    const auto [ac1, ac2, ac3, ac4, ac5, ac6, b1, b2, mb, mc, md] = kWords;
    const long b6 = b5 - 4000;
    long x3 = (b2 * (b6 * b6 >> 12) >> 11) + (ac2 * b6 >> 11);
    const long b3 = (((ac1 * 4L + x3) << oss) + 2) / 4;
    x3 = ((ac3 * b6 >> 13) + (b1 * (b6 * b6 >> 12) >> 16) + 2) >> 2;
    const unsigned long b4 = ac4 * static_cast<unsigned long>(x3 + 32768) >> 15;
    const unsigned long b7 = (static_cast<unsigned long>(raw) - static_cast<unsigned long>(b3)) *
                             static_cast<unsigned long>(50000 >> oss);
    const long p = static_cast<long>(b7 < 0x80000000UL ? b7 * 2 / b4 : b7 / b4 * 2);
    const long x1 = ((p >> 8) * (p >> 8) * 3038) >> 16;
    return p + ((x1 + (-7357 * p >> 16) + 3791) >> 4);
}

/// A pressure sensor: what it is told to measure is there some milliseconds later.
class Bmp085 final : public I2cChip {
  public:
    Bmp085(std::string name, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), bmp085_part(), kAddress, kQuantities, std::move(values), context),
          ready_(context.clock, [this] { result_ = next_result_; }) {}

  private:
    std::uint8_t read_register(std::uint8_t number) override {
        if (number >= kFirstWord && number < kFirstWord + 2 * kWords.size()) {
            const auto word = static_cast<unsigned>(kWords[(number - kFirstWord) / 2u]);
            return static_cast<std::uint8_t>((number - kFirstWord) % 2 == 0 ? word >> 8 : word);
        }
        if (number < kResult || number > kResult + 2)
            return number == kChip ? 0x55 : number == kChip + 1 ? 2 : 0;
        return static_cast<std::uint8_t>(result_ >> (8 * (kResult + 2 - number)));
    }
    void write_register(std::uint8_t number, std::uint8_t value) override {
        if (number != kControl) return;
        const long raw_temperature = raw_of(20300, 65535, value_of_temperature(),
                                            [](long raw) { return temperature_of(raw).temperature; });
        if (value == kMeasureTemperature) return measure(raw_temperature << 8, kTemperatureUs);
        if ((value & 0x3f) != kMeasurePressure) return;
        const int oss = value >> 6;
        const long b5 = temperature_of(raw_temperature).b5;
        const long raw = raw_of(0, 65535L << oss, value_of_pressure(),
                                [&](long candidate) { return pressure_of(candidate, b5, oss); });
        measure(raw << (8 - oss), kPressureUs[static_cast<std::size_t>(oss)]);
    }
    void power_on() override {
        ready_.cancel();
        result_ = 0;
    }

    double value_of_pressure() const { return value(0) * 100; }
    double value_of_temperature() const { return std::round(value(1) * 10); }

    void measure(long result, double microseconds) {
        next_result_ = result;
        ready_.at(context().clock.cycle() +
                  static_cast<std::uint64_t>(microseconds * context().cycles_per_us));
    }

    Alarm ready_;
    long result_ = 0;  // 24 bits
    long next_result_ = 0;
};

PartPlan read_bmp085(PartReader& reader) {
    return read_i2c_chip<Bmp085>(reader, kQuantities);
}

}  // namespace bmp085

const PartKind& bmp085_part() {
    static constexpr PartKind kind{"bmp085", I2cChip::kVerbs, bmp085::read_bmp085};
    return kind;
}

}  // namespace asip::sim
