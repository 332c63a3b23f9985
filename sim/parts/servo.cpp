// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/servo_pulse.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& servo_part();

namespace {

/// A hobby servo; its angle is what its pulses ask for.
struct ServoSpec {
    int pin = 0;
};

class Servo final : public Part {
  public:
    Servo(std::string name, const ServoSpec& spec, PartContext& context)
        : Part(std::move(name), servo_part()),
          pulse_(context, spec.pin, [this, &context] { context.changed(*this); }) {}

    std::string state() const override { return pulse_.angle() ? std::to_string(*pulse_.angle()) : "none"; }

  private:
    ServoPulse pulse_;
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
