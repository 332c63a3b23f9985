#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "sim/part_context.hpp"
#include "sim/part_reader.hpp"
#include "sim/parts/numbers.hpp"

namespace asip::sim {

const PartKind& ultrasonic_part();

namespace {

/// An ultrasonic distance sensor. With `echo` equal to `trigger` it is the one-pin kind that ASIP's Distance
/// service uses: the echo comes back on the pin that triggered it.
struct UltrasonicSpec {
    int trigger = 0;
    int echo = 0;
    double distance_cm = 100;  ///< above 400: no echo, as when nothing is in range
};

// Sound at 20 degrees: 343 m/s, there and back.
constexpr double kEchoMicrosecondsPerCm = 58.31;
constexpr double kMaxRangeCm = 400;
constexpr double kMaxDistanceCm = 10000;
constexpr double kMinTriggerUs = 2;
// From the trigger's end to the echo's beginning.
constexpr double kBurstUs = 450;
// How long the usual sensors hold their echo when none came back.
constexpr double kNothingInRangeUs = 38000;

/// After a trigger pulse the echo pin goes high for as long as the sound was on its way.
class Ultrasonic final : public Part {
  public:
    Ultrasonic(std::string name, const UltrasonicSpec& spec, PartContext& context)
        : Part(std::move(name), ultrasonic_part()),
          spec_(spec),
          context_(context),
          echo_(context.clock, [this] { step(); }) {
        context.wiring.watch(spec.trigger, [this](PinState pin) { on_trigger(pin); });
        if (!one_pin()) context.wiring.drive(spec.echo, false);
    }

    std::string state() const override { return unplugged_ ? "none" : short_number(spec_.distance_cm); }

  private:
    Expected<void> perform(std::string_view, std::string_view argument) override {
        const auto distance = parse_number(argument);
        if (argument != "none" && (!distance || *distance < 0 || *distance > kMaxDistanceCm))
            return fail(fmt::format("an ultrasonic is set to centimetres (0 to {}) or none, not to \"{}\"",
                                    kMaxDistanceCm, argument));
        const auto before = state();
        unplugged_ = !distance;
        if (distance) spec_.distance_cm = *distance;
        if (state() != before) context_.changed(*this);
        return {};
    }

    enum class Phase { kIdle, kBurst, kEcho };

    bool one_pin() const { return spec_.echo == spec_.trigger; }

    std::uint64_t cycles(double microseconds) const {
        return static_cast<std::uint64_t>(std::llround(microseconds * context_.cycles_per_us));
    }

    void on_trigger(PinState pin) {
        if (phase_ != Phase::kIdle) return;
        const auto now = context_.clock.cycle();
        if (pin.output && pin.high) {
            if (!rose_at_) rose_at_ = now;
            return;
        }
        const bool triggered = rose_at_ && now - *rose_at_ >= cycles(kMinTriggerUs);
        rose_at_.reset();
        if (!triggered || unplugged_) return;
        phase_ = Phase::kBurst;
        context_.wiring.drive(spec_.echo, false);
        echo_.at(now + cycles(kBurstUs));
    }

    void step() {
        if (phase_ == Phase::kBurst) {
            const bool in_range = spec_.distance_cm <= kMaxRangeCm;
            phase_ = Phase::kEcho;
            context_.wiring.drive(spec_.echo, true);
            // From the moment the pin really rose: the width of the pulse is the measurement.
            echo_.at(context_.clock.cycle() +
                     cycles(in_range ? spec_.distance_cm * kEchoMicrosecondsPerCm : kNothingInRangeUs));
            return;
        }
        phase_ = Phase::kIdle;
        context_.wiring.drive(spec_.echo, false);
        if (one_pin()) context_.wiring.release(spec_.echo);
    }

    UltrasonicSpec spec_;
    PartContext& context_;
    Alarm echo_;
    Phase phase_ = Phase::kIdle;
    std::optional<std::uint64_t> rose_at_;
    bool unplugged_ = false;
};

PartPlan read_ultrasonic(PartReader& reader) {
    const bool two_pins = reader.has("trigger") || reader.has("echo");
    const int trigger = reader.pin(two_pins ? "trigger" : "pin");
    const int echo = two_pins ? reader.pin("echo") : trigger;
    const UltrasonicSpec spec{trigger, echo, reader.number("distance", 100, 0, kMaxDistanceCm)};
    PartPlan plan{.claims = {}, .timed = true, .make = maker<Ultrasonic>(spec)};
    if (trigger != echo) plan.claims.push_back({trigger, PinUse::kListens});
    plan.claims.push_back({echo, PinUse::kDrives});
    return plan;
}

constexpr std::array kUltrasonicVerbs{
    PartVerb{"set", "CM", "put something in front of a distance sensor (none: it does not answer)"}};

}  // namespace

const PartKind& ultrasonic_part() {
    static constexpr PartKind kind{"ultrasonic", kUltrasonicVerbs, read_ultrasonic};
    return kind;
}

}  // namespace asip::sim
