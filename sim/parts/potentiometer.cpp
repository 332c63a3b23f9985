// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "sim/parts/numbers.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& potentiometer_part();

namespace {

/// A potentiometer between ground and VCC on an analog pin.
struct PotentiometerSpec {
    int pin = 0;
    double position = 0.5;  ///< 0 = ground, 1 = VCC
};

constexpr double kSliderMillivolts = 5000;

class Potentiometer final : public Part {
  public:
    Potentiometer(std::string name, const PotentiometerSpec& spec, PartContext& context)
        : Part(std::move(name), potentiometer_part()), spec_(spec), context_(context) {
        apply();
    }

    std::string state() const override { return short_number(spec_.position); }

    void after_reset() override { apply(); }

  private:
    Expected<void> perform(std::string_view, std::string_view argument) override {
        const auto position = parse_number(argument);
        if (!position || *position < 0 || *position > 1)
            return fail(fmt::format("a potentiometer is set from 0 to 1, not to \"{}\"", argument));
        if (*position == spec_.position) return {};
        spec_.position = *position;
        apply();
        context_.changed(*this);
        return {};
    }

    void apply() {
        context_.wiring.set_millivolts(spec_.pin,
                                       static_cast<int>(std::lround(spec_.position * kSliderMillivolts)));
    }

    PotentiometerSpec spec_;
    PartContext& context_;
};

PartPlan read_potentiometer(PartReader& reader) {
    const PotentiometerSpec spec{reader.pin("pin"), reader.number("position", 0.5, 0, 1)};
    return {.claims = {{spec.pin, PinUse::kDrives, true}}, .make = maker<Potentiometer>(spec)};
}

constexpr std::array kPotentiometerVerbs{PartVerb{"set", "0..1", "turn a potentiometer"}};

}  // namespace

const PartKind& potentiometer_part() {
    static constexpr PartKind kind{"potentiometer", kPotentiometerVerbs, read_potentiometer};
    return kind;
}

}  // namespace asip::sim
