// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "sim/parts/i2c_chip.hpp"

namespace asip::sim {

const PartKind& pca9685_part();

namespace pca9685 {

// From the data sheet of the PCA9685.
constexpr std::uint8_t kAddress = 0x40;
constexpr std::uint8_t kMode1 = 0x00, kFirstOutput = 0x06, kAllOutputs = 0xfa, kPrescale = 0xfe;
constexpr std::uint8_t kAsleep = 0x10, kSteps = 0x20, kRestart = 0x80;
constexpr std::size_t kOutputs = 16, kBytes = 4;
constexpr double kOscillator = 25e6;
constexpr int kSlots = 4096;

/// Sixteen outputs that are high for a part of each period: servos, lamps.
class Pca9685 final : public I2cChip {
  public:
    Pca9685(std::string name, std::vector<double> values, PartContext& context)
        : I2cChip(std::move(name), pca9685_part(), kAddress, {}, std::move(values), context) {}

    /// The frequency, and of each output that is not off how many of 4096 slots of a period it is high:
    /// `50 Hz 0:307 15:4096`; `asleep`.
    std::string state() const override {
        const auto own = I2cChip::state();
        if (!own.empty()) return own;
        if ((mode1_ & kAsleep) != 0) return "asleep";
        auto text = fmt::format("{} Hz", std::lround(kOscillator / kSlots / (prescale_ + 1)));
        for (std::size_t output = 0; output < kOutputs; ++output)
            if (const int high = slots(output); high != 0) text += fmt::format(" {}:{}", output, high);
        return text;
    }

  private:
    std::uint8_t read_register(std::uint8_t number) override {
        if (number == kMode1) return mode1_;
        if (number == kPrescale) return prescale_;
        const std::size_t place = static_cast<std::size_t>(number) - kFirstOutput;
        return number >= kFirstOutput && place < outputs_.size() ? outputs_[place] : 0;
    }
    void write_register(std::uint8_t number, std::uint8_t value) override {
        const auto before = state();
        const std::size_t place = static_cast<std::size_t>(number) - kFirstOutput;
        if (number == kMode1) {
            mode1_ = static_cast<std::uint8_t>(value & ~kRestart);
        } else if (number == kPrescale) {
            if ((mode1_ & kAsleep) != 0) prescale_ = value < 3 ? 3 : value;
        } else if (number >= kAllOutputs && number < kPrescale) {
            for (std::size_t output = 0; output < kOutputs; ++output)
                outputs_[output * kBytes + (number - kAllOutputs)] = value;
        } else if (number >= kFirstOutput && place < outputs_.size()) {
            outputs_[place] = value;
        }
        if (state() != before) context().changed(*this);
    }
    bool steps() const override { return (mode1_ & kSteps) != 0; }
    void power_on() override {
        mode1_ = kAsleep | 1;
        prescale_ = kUsual;
        outputs_ = usual_outputs();
    }

    int slots(std::size_t output) const {
        const auto word = [&](std::size_t at) {
            return outputs_[output * kBytes + at] | (outputs_[output * kBytes + at + 1] & 0x1f) << 8;
        };
        const int on = word(0), off = word(2);
        if ((off & kSlots) != 0) return 0;
        if ((on & kSlots) != 0) return kSlots;
        return off >= on ? off - on : kSlots - on + off;
    }

    static constexpr std::uint8_t kUsual = 0x1e;
    static std::array<std::uint8_t, kOutputs * kBytes> usual_outputs() {
        std::array<std::uint8_t, kOutputs * kBytes> all{};
        for (std::size_t output = 0; output < kOutputs; ++output)
            all[output * kBytes + 3] = kSlots >> 8;  // off
        return all;
    }

    std::uint8_t mode1_ = kAsleep | 1;
    std::uint8_t prescale_ = kUsual;
    std::array<std::uint8_t, kOutputs * kBytes> outputs_ = usual_outputs();
};

PartPlan read_pca9685(PartReader& reader) {
    return read_i2c_chip<Pca9685>(reader, {});
}

constexpr std::array kPca9685Verbs{PartVerb{"detach", "", "take a chip off its bus"},
                                   PartVerb{"attach", "", "put it back"}};

}  // namespace pca9685

const PartKind& pca9685_part() {
    static constexpr PartKind kind{"pca9685", pca9685::kPca9685Verbs, pca9685::read_pca9685};
    return kind;
}

}  // namespace asip::sim
