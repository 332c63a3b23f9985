#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "sim/part_context.hpp"
#include "sim/parts/numbers.hpp"

namespace asip::sim {
namespace {

// Sound at 20 degrees: 343 m/s, there and back.
constexpr double kEchoMicrosecondsPerCm = 58.31;
constexpr double kFarthestCm = 400;
constexpr double kShortestTriggerUs = 2;
constexpr double kBurstUs = 450;             // from the trigger's end to the echo's beginning
constexpr double kNothingInRangeUs = 38000;  // how long the usual sensors hold their echo when none came back

/// After a trigger pulse the echo pin goes high for as long as the sound was on its way.
class Ultrasonic final : public Part {
  public:
    Ultrasonic(std::string name, const UltrasonicSpec& spec, PartContext& context)
        : Part(std::move(name)), spec_(spec), context_(context), echo_(context.clock, [this] { step(); }) {
        context.wiring.watch(spec.trigger, [this](PinState pin) { on_trigger(pin); });
        if (!one_pin()) context.wiring.drive(spec.echo, false);
    }

    std::string_view kind() const override { return "ultrasonic"; }
    std::string state() const override { return unplugged_ ? "none" : short_number(spec_.distance_cm); }

    Expected<void> command(std::string_view verb, std::string_view argument) override {
        if (verb != "set")
            return fail(fmt::format("an ultrasonic has no command \"{}\": set CENTIMETRES|none", verb));
        const auto distance = parse_number(argument);
        if (argument != "none" && (!distance || *distance < 0 || *distance > 10000))
            return fail(fmt::format("an ultrasonic is set to centimetres (0 to 10000) or none, not to \"{}\"",
                                    argument));
        const auto before = state();
        unplugged_ = !distance;
        if (distance) spec_.distance_cm = *distance;
        if (state() != before) context_.changed(*this);
        return {};
    }

  private:
    enum class Phase { idle, burst, echo };

    bool one_pin() const { return spec_.echo == spec_.trigger; }

    std::uint64_t cycles(double microseconds) const {
        return static_cast<std::uint64_t>(std::llround(microseconds * context_.cycles_per_us));
    }

    void on_trigger(PinState pin) {
        if (phase_ != Phase::idle) return;
        const auto now = context_.clock.cycle();
        if (pin.output && pin.high) {
            if (!rose_at_) rose_at_ = now;
            return;
        }
        const bool triggered = rose_at_ && now - *rose_at_ >= cycles(kShortestTriggerUs);
        rose_at_.reset();
        if (!triggered || unplugged_) return;
        phase_ = Phase::burst;
        context_.wiring.drive(spec_.echo, false);
        echo_.at(now + cycles(kBurstUs));
    }

    void step() {
        if (phase_ == Phase::burst) {
            const bool in_range = spec_.distance_cm >= 0 && spec_.distance_cm <= kFarthestCm;
            phase_ = Phase::echo;
            context_.wiring.drive(spec_.echo, true);
            // From the moment the pin really rose: the width of the pulse is the measurement.
            echo_.at(context_.clock.cycle() +
                     cycles(in_range ? spec_.distance_cm * kEchoMicrosecondsPerCm : kNothingInRangeUs));
            return;
        }
        phase_ = Phase::idle;
        context_.wiring.drive(spec_.echo, false);
        if (one_pin()) context_.wiring.release(spec_.echo);
    }

    UltrasonicSpec spec_;
    PartContext& context_;
    Alarm echo_;
    Phase phase_ = Phase::idle;
    std::optional<std::uint64_t> rose_at_;
    bool unplugged_ = false;
};

}  // namespace

std::unique_ptr<Part> make_part(const std::string& name, const UltrasonicSpec& spec, PartContext& context) {
    return std::make_unique<Ultrasonic>(name, spec, context);
}

}  // namespace asip::sim
