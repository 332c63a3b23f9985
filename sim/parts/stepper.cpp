// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& stepper_part();

namespace {

/// A 28BYJ-48 behind a ULN2003, or any motor behind an A4988, and the carriage that it moves: at `switch_at`
/// and below it closes a switch to ground.
struct StepperSpec {
    std::vector<int> pins;  ///< four: IN1 to IN4; three: STEP, DIR, ENABLE
    int switch_pin = -1;
    long switch_at = 0;
};

/// The data sheet of the 28BYJ-48 says that it starts at up to 600 steps a second, and follows up to 1,000.
constexpr double kStartUs = 1e6 / 600, kFollowUs = 1e6 / 1000;
/// The one of the A4988 says that a step is high and low for 1 us at least, and DIR and ENABLE stand for 200
/// ns before.
constexpr double kPulseUs = 1, kSetUpUs = 0.2;

class Stepper final : public Part {
  public:
    Stepper(std::string name, const StepperSpec& spec, PartContext& context)
        : Part(std::move(name), stepper_part()), spec_(spec), context_(context) {
        for (std::size_t at = 0; at < spec.pins.size(); ++at)
            context.wiring.watch(spec.pins[at], [this, at](PinState pin) { on_pin(at, pin); });
        press();
    }

    std::string state() const override { return std::to_string(position_) + (has_power() ? " on" : " off"); }

  private:
    bool has_coils() const { return spec_.pins.size() == 4; }
    bool has_power() const { return has_coils() ? high_ != 0 : (high_ & 4) == 0; }

    void on_pin(std::size_t at, PinState pin) {
        const auto bit = 1u << at;
        const bool had_power = has_power();
        const bool high = pin.output && pin.high;
        if (high == ((high_ & bit) != 0)) return;
        high_ = high ? high_ | bit : high_ & ~bit;
        if (has_coils())
            turn();
        else
            count(at, high);
        if (has_power() != had_power) context_.changed(*this);
    }

    double us_since(std::uint64_t cycle) const {
        return static_cast<double>(context_.clock.cycle() - cycle) / context_.cycles_per_us;
    }

    /// The rotor turns to the field of its coils by the shorter way, if it can follow; fields that are
    /// opposite to it, or none, leave it where it is.
    void turn() {
        constexpr std::array<unsigned, 8> kFields{1, 3, 2, 6, 4, 12, 8, 9};
        for (int field = 0; field < 8; ++field) {
            if (kFields[static_cast<std::size_t>(field)] != high_) continue;
            const long way = (field - position_ % 8 + 20) % 8 - 4;
            const double us = us_since(turned_at_);
            const bool follows = us >= kStartUs || (us >= kFollowUs && last_us_ < 2 * kStartUs);
            turned_at_ = context_.clock.cycle();
            last_us_ = us;
            if (way != -4 && follows) move(way);
        }
    }

    void count(std::size_t at, bool high) {
        if (at != 0) {
            set_at_ = context_.clock.cycle();
        } else if (high) {
            counts_ = us_since(turned_at_) >= kPulseUs && us_since(set_at_) >= kSetUpUs && has_power();
            turned_at_ = context_.clock.cycle();
        } else {
            if (counts_ && us_since(turned_at_) >= kPulseUs) move((high_ & 2) != 0 ? 1 : -1);
            turned_at_ = context_.clock.cycle();
        }
    }

    void move(long steps) {
        if (steps == 0) return;
        position_ += steps;
        press();
        context_.changed(*this);
    }

    void press() {
        if (spec_.switch_pin < 0) return;
        if (position_ <= spec_.switch_at)
            context_.wiring.drive(spec_.switch_pin, false);
        else
            context_.wiring.release(spec_.switch_pin);
    }

    StepperSpec spec_;
    PartContext& context_;
    unsigned high_ = 0;  // a bit for each pin
    long position_ = 0;
    std::uint64_t turned_at_ = 0, set_at_ = 0;
    double last_us_ = 0;
    bool counts_ = false;
};

PartPlan read_stepper(PartReader& reader) {
    StepperSpec spec;
    if (reader.has("step"))
        spec.pins = {reader.pin("step"), reader.pin("direction"), reader.pin("enable")};
    else
        spec.pins = reader.pins("coils", {8, 9, 10, 11});
    PartPlan plan;
    for (const int pin : spec.pins)
        plan.claims.push_back({pin, PinUse::kListens});
    if (reader.has("switch")) {
        spec.switch_pin = reader.pin("switch");
        spec.switch_at = static_cast<long>(reader.number("switch_at", -1000, -1e6, 1e6));
        plan.claims.push_back({spec.switch_pin, PinUse::kDrives});
    }
    plan.make = maker<Stepper>(spec);
    return plan;
}

}  // namespace

const PartKind& stepper_part() {
    static constexpr PartKind kind{"stepper", {}, read_stepper};
    return kind;
}

}  // namespace asip::sim
