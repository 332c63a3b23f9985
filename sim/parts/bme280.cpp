// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& bme280_part();

namespace bme280 {

constexpr std::array kQuantities{Quantity{"temperature", 20, -40, 85}, Quantity{"humidity", 40, 0, 100},
                                 Quantity{"pressure", 1013.25, 300, 1100}};

// From the data sheets of BME280 and BMP280. The words of temperature and pressure are those of its example.
constexpr std::uint8_t kAddress = 0x76;
constexpr std::uint8_t kIdentity = 0xd0, kReset = 0xe0, kControlHumidity = 0xf2, kStatus = 0xf3,
                       kControl = 0xf4;
constexpr std::uint8_t kResult = 0xf7, kWords = 0x88, kH1 = 0xa1, kH2 = 0xe1;
constexpr std::uint8_t kBme280 = 0x60, kBmp280 = 0x58, kResetWord = 0xb6, kMeasuring = 8;
constexpr std::array<double, 3> kT{27504, 26435, -1000};
constexpr std::array<double, 9> kP{36477, -10685, 3024, 2855, 140, -7, 15500, -14600, 6000};
constexpr std::array<int, 6> kH{75, 370, 0, 313, 50, 30};
constexpr std::array<std::uint8_t, 8> kNothing{0x80, 0, 0, 0x80, 0, 0, 0x80, 0};

// The conversion of the data sheet in floating point: the firmware has the one in integers.
double fine_of(double raw) {
    const double offset = raw / 131072 - kT[0] / 8192;
    return (raw / 16384 - kT[0] / 1024) * kT[1] + offset * offset * kT[2];
}
double pressure_of(double raw, double fine) {
    const double t = fine / 2 - 64000;
    const double offset = (t * t * kP[5] / 32768 + t * kP[4] * 2) / 4 + kP[3] * 65536;
    const double slope = (1 + (kP[2] * t * t / 524288 + kP[1] * t) / 524288 / 32768) * kP[0];
    const double pascals = (1048576 - raw - offset / 4096) * 6250 / slope;
    return (pascals + (kP[8] * pascals * pascals / 2147483648. + pascals * kP[7] / 32768 + kP[6]) / 16) / 100;
}
double humidity_of(double raw, double fine) {
    const double t = fine - 76800;
    const double linear = (raw - (kH[3] * 64. + kH[4] / 16384. * t)) *
                          (kH[1] / 65536. * (1 + kH[5] / 67108864. * t * (1 + kH[2] / 67108864. * t)));
    return linear * (1 - kH[0] * linear / 524288);
}

/// A sensor of temperature, humidity and pressure, or of two of these: it measures once when it is told so.
class Bme280 final : public I2cChip {
  public:
    Bme280(std::string name, bool bmp280, std::uint8_t address, std::vector<double> values,
           PartContext& context)
        : I2cChip(std::move(name), bme280_part(), address, kQuantities, std::move(values), context),
          bmp280_(bmp280),
          ready_(context.clock, [this] { finish(); }) {}

  private:
    std::uint8_t read_register(std::uint8_t number) override {
        if (number == kIdentity) return bmp280_ ? kBmp280 : kBme280;
        if (number >= kWords && number < kWords + 24) return word_byte(number - kWords);
        if (number >= kResult && number < kResult + result_.size()) return result_[number - kResult];
        if (number == kStatus) return measuring_ ? kMeasuring : 0;
        if (bmp280_) return 0;
        if (number == kH1) return static_cast<std::uint8_t>(kH[0]);
        if (number >= kH2 && number < kH2 + 7) return humidity_byte(number - kH2);
        return number == kControlHumidity ? humidity_bits_ : 0;
    }
    void write_register(std::uint8_t number, std::uint8_t value) override {
        if (number == kReset && value == kResetWord) return power_on();
        if (number == kControlHumidity) humidity_bits_ = value & 7;
        const bool once = (value & 3) == 1 || (value & 3) == 2;
        if (number != kControl || !once) return;
        with_temperature_ = (value >> 5) != 0;
        with_pressure_ = (value >> 2 & 7) != 0;
        with_humidity_ = !bmp280_ && humidity_bits_ != 0;  // counts from the next control byte on
        measuring_ = true;
        const double us =
            1250 + taken(value >> 5) + taken(value >> 2 & 7) + (with_humidity_ ? taken(humidity_bits_) : 0);
        ready_.at(context().clock.cycle() + static_cast<std::uint64_t>(us * context().cycles_per_us));
    }
    void power_on() override {
        ready_.cancel();
        measuring_ = false;
        humidity_bits_ = 0;
        result_ = kNothing;
    }

    /// The longest time, with the oversampling of these three bits.
    static double taken(unsigned bits) {
        return bits == 0 ? 0 : 2300 * (1u << (std::min(bits, 5u) - 1)) + 575;
    }
    static std::uint8_t word_byte(int byte) {
        const auto index = static_cast<std::size_t>(byte / 2);
        const auto word =
            static_cast<unsigned>(static_cast<int>(index < kT.size() ? kT[index] : kP[index - kT.size()]));
        return static_cast<std::uint8_t>(byte % 2 == 0 ? word : word >> 8);
    }
    static std::uint8_t humidity_byte(int byte) {
        const auto h2 = static_cast<unsigned>(kH[1]), h4 = static_cast<unsigned>(kH[3]),
                   h5 = static_cast<unsigned>(kH[4]);
        const std::array<unsigned, 7> bytes{h2,
                                            h2 >> 8,
                                            static_cast<unsigned>(kH[2]),
                                            h4 >> 4,
                                            (h4 & 15) | (h5 & 15) << 4,
                                            h5 >> 4,
                                            static_cast<unsigned>(kH[5])};
        return static_cast<std::uint8_t>(bytes[static_cast<std::size_t>(byte)]);
    }

    void finish() {
        measuring_ = false;
        const long temperature = raw_of(0, 0xfffff, value(0), [](double raw) { return fine_of(raw) / 5120; });
        const double fine = fine_of(static_cast<double>(temperature));
        const long pressure =
            raw_of(0, 0xfffff, -value(2), [&](double raw) { return -pressure_of(raw, fine); });
        const long humidity = raw_of(0, 0xffff, value(1), [&](double raw) { return humidity_of(raw, fine); });
        result_ = kNothing;
        if (with_pressure_) put(0, pressure << 4);
        if (with_temperature_) put(3, temperature << 4);
        if (!with_humidity_) return;
        result_[6] = static_cast<std::uint8_t>(humidity >> 8);
        result_[7] = static_cast<std::uint8_t>(humidity);
    }
    void put(std::size_t at, long bits) {
        for (std::size_t i = 0; i < 3; ++i)
            result_[at + i] = static_cast<std::uint8_t>(bits >> (16 - 8 * i));
    }

    bool bmp280_;
    Alarm ready_;
    bool measuring_ = false, with_temperature_ = false, with_pressure_ = false, with_humidity_ = false;
    std::uint8_t humidity_bits_ = 0;
    std::array<std::uint8_t, 8> result_ = kNothing;
};

PartPlan read_bme280(PartReader& reader) {
    const bool bmp280 = reader.flag("bmp280");
    const auto address =
        static_cast<std::uint8_t>(reader.number("address", kAddress, kAddress, kAddress + 1));
    return read_i2c_chip<Bme280>(reader, kQuantities, bmp280, address);
}

}  // namespace bme280

const PartKind& bme280_part() {
    static constexpr PartKind kind{"bme280", I2cChip::kVerbs, bme280::read_bme280};
    return kind;
}

}  // namespace asip::sim
