// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "sim/parts/echo.hpp"
#include "sim/parts/numbers.hpp"
#include "sim/wiring/part_reader.hpp"

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

constexpr double kMaxDistanceCm = 10000;

class Ultrasonic final : public Part {
  public:
    Ultrasonic(std::string name, const UltrasonicSpec& spec, PartContext& context)
        : Part(std::move(name), ultrasonic_part()),
          distance_cm_(spec.distance_cm),
          context_(context),
          echo_(context, spec.trigger, spec.echo,
                [this] { return unplugged_ ? std::nullopt : std::optional(distance_cm_); }) {}

    std::string state() const override { return unplugged_ ? "none" : short_number(distance_cm_); }

  private:
    Expected<void> perform(std::string_view, std::string_view argument) override {
        const auto distance = parse_number(argument);
        if (argument != "none" && (!distance || *distance < 0 || *distance > kMaxDistanceCm))
            return fail(fmt::format("an ultrasonic is set to centimetres (0 to {}) or none, not to \"{}\"",
                                    kMaxDistanceCm, argument));
        const auto before = state();
        unplugged_ = !distance;
        if (distance) distance_cm_ = *distance;
        if (state() != before) context_.changed(*this);
        return {};
    }

    double distance_cm_;
    bool unplugged_ = false;
    PartContext& context_;
    Echo echo_;
};

PartPlan read_ultrasonic(PartReader& reader) {
    const bool two_pins = reader.has("trigger") || reader.has("echo");
    const int trigger = reader.pin(two_pins ? "trigger" : "pin");
    const int echo = two_pins ? reader.pin("echo") : trigger;
    const UltrasonicSpec spec{trigger, echo, reader.number("distance", 100, 0, kMaxDistanceCm)};
    PartPlan plan{.claims = {}, .timers = 1, .make = maker<Ultrasonic>(spec)};
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
