#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/part_context.hpp"
#include "sim/part_reader.hpp"

namespace asip::sim {

const PartKind& servo_part();

namespace {

/// A hobby servo; its angle is what its pulses ask for (544 us = 0, 2400 us = 180 degrees).
struct ServoSpec {
    int pin = 0;
};

constexpr double kPulseAt0Us = 544;
constexpr double kPulseAt180Us = 2400;
// A servo ignores other pulses.
constexpr double kMinPulseUs = 400;
constexpr double kMaxPulseUs = 2600;

class Servo final : public Part {
  public:
    Servo(std::string name, const ServoSpec& spec, PartContext& context)
        : Part(std::move(name), servo_part()), context_(context) {
        context.wiring.watch(spec.pin, [this](PinState pin) { on_pin(pin); });
    }

    std::string state() const override { return angle_ ? std::to_string(*angle_) : "none"; }

  private:
    void on_pin(PinState pin) {
        const auto now = context_.clock.cycle();
        if (pin.high) {
            if (!rose_at_) rose_at_ = now;
            return;
        }
        if (!rose_at_) return;
        const double pulse = static_cast<double>(now - *rose_at_) / context_.cycles_per_us;
        rose_at_.reset();
        if (pulse < kMinPulseUs || pulse > kMaxPulseUs) return;
        const double angle = (pulse - kPulseAt0Us) / (kPulseAt180Us - kPulseAt0Us) * 180;
        const int rounded = static_cast<int>(std::lround(std::clamp(angle, 0.0, 180.0)));
        if (angle_ == rounded) return;
        angle_ = rounded;
        context_.changed(*this);
    }

    PartContext& context_;
    std::optional<std::uint64_t> rose_at_;
    std::optional<int> angle_;
};

PartPlan read_servo(PartReader& reader) {
    const ServoSpec spec{reader.pin("pin")};
    return {.claims = {{spec.pin, PinUse::kListens}}, .make = maker<Servo>(spec)};
}

}  // namespace

const PartKind& servo_part() {
    static constexpr PartKind kind{"servo", {}, read_servo};
    return kind;
}

}  // namespace asip::sim
