// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "sim/parts/numbers.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& values_part();

namespace {

/// A number on a pin. Of an analog pin `min` to `max` is 0 to 5 V, of a PWM pin its duty; a level is one of
/// the two.
struct PinValue {
    std::string name;
    int pin = 0;
    double min = 0, max = 0;
    double value = 0;  ///< of an input
    bool analog = false;
};

/// Hardware that is not there yet: numbers that the board reads and numbers that it sets, each on a pin.
struct ValuesSpec {
    std::vector<PinValue> inputs;   ///< of the board
    std::vector<PinValue> outputs;  ///< of the board
};

constexpr double kAdcSteps = 1023;
constexpr double kVccMillivolts = 5000;
constexpr double kDutySteps = 255;

// Rounded up, as firmware that scales with whole numbers rounds down: what it reads is what was set.
int millivolts_for(const PinValue& input) {
    const double steps = std::ceil((input.value - input.min) * kAdcSteps / (input.max - input.min) - 1e-9);
    return static_cast<int>(std::ceil(steps * kVccMillivolts / kAdcSteps));
}

double value_of_duty(const PinValue& output, int duty) {
    return output.min + std::ceil(duty * (output.max - output.min) / kDutySteps - 1e-9);
}

class Values final : public Part {
  public:
    Values(std::string name, const ValuesSpec& spec, PartContext& context)
        : Part(std::move(name), values_part()), spec_(spec), context_(context) {
        for (const auto& output : spec_.outputs) {
            context.wiring.watch(output.pin, [this](PinState) { update(); });
            context.wiring.watch_pwm(output.pin, [this] { update(); });
        }
        apply();
        state_ = look();
    }

    /// "speed0=1200,power0=50"; an output that the board does not drive yet is "-".
    std::string state() const override { return state_; }

    void after_reset() override { apply(); }

  private:
    Expected<void> perform(std::string_view, std::string_view argument) override {
        auto inputs = spec_.inputs;
        for (const auto& [name, text] : assignments(argument)) {
            const auto found =
                std::find_if(inputs.begin(), inputs.end(),
                             [wanted = name](const PinValue& one) { return one.name == wanted; });
            if (found == inputs.end())
                return fail(fmt::format("{} has nothing to set that is called \"{}\"; there is: {}",
                                        this->name(), name, input_names()));
            const auto value = parse_number(text);
            if (!value || *value < found->min || *value > found->max)
                return fail(fmt::format("{} is a number from {} to {}, not \"{}\"", name, found->min,
                                        found->max, text));
            if (!found->analog && *value != found->min && *value != found->max)
                return fail(
                    fmt::format("{} is {} or {}, as it is on a digital pin", name, found->min, found->max));
            found->value = *value;
        }
        spec_.inputs = std::move(inputs);
        apply();
        update();
        return {};
    }

    std::string input_names() const {
        std::vector<std::string_view> names;
        for (const auto& input : spec_.inputs)
            names.push_back(input.name);
        return names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "));
    }

    void apply() {
        for (const auto& input : spec_.inputs)
            if (input.analog)
                context_.wiring.set_millivolts(input.pin, millivolts_for(input));
            else
                context_.wiring.drive(input.pin, input.value == input.max);
    }

    std::string shown(const PinValue& output) const {
        const auto pin = context_.wiring.pin(output.pin);
        if (!pin.output) return "-";
        const auto duty = context_.wiring.pwm(output.pin);
        return short_number(value_of_duty(output, duty       ? *duty
                                                  : pin.high ? static_cast<int>(kDutySteps)
                                                             : 0));
    }

    std::string look() const {
        std::vector<std::string> all;
        for (const auto& input : spec_.inputs)
            all.push_back(fmt::format("{}={}", input.name, short_number(input.value)));
        for (const auto& output : spec_.outputs)
            all.push_back(fmt::format("{}={}", output.name, shown(output)));
        return fmt::format("{}", fmt::join(all, ","));
    }

    void update() {
        auto now = look();
        if (now == state_) return;
        state_ = std::move(now);
        context_.changed(*this);
    }

    ValuesSpec spec_;
    PartContext& context_;
    std::string state_;
};

PinValue read_value(PartReader& reader, std::set<std::string>& names) {
    constexpr double kMost = 1e9;
    PinValue value{reader.text("name"), reader.pin("pin"), reader.number("min", 0, -kMost, kMost),
                   reader.number("max", kAdcSteps, -kMost, kMost)};
    if (value.name.find_first_of(" \t,=") != std::string::npos)
        reader.fault("name", "has a space, a comma or \"=\" in it");
    else if (!names.insert(value.name).second)
        reader.fault("name", "is there twice");
    if (value.max <= value.min) reader.fault("max", "must be above min");
    return value;
}

PartPlan read_values(PartReader& reader) {
    ValuesSpec spec;
    PartPlan plan;
    std::set<std::string> names;
    reader.each("inputs", [&](PartReader& item) {
        auto value = read_value(item, names);
        value.value = item.number("value", value.min, value.min, std::max(value.min, value.max));
        value.analog = item.is_analog(value.pin);
        if (!value.analog && value.value != value.min && value.value != value.max)
            item.fault("value", "on a digital pin it is min or max");
        plan.claims.push_back({value.pin, PinUse::kDrives, value.analog});
        spec.inputs.push_back(std::move(value));
    });
    reader.each("outputs", [&](PartReader& item) {
        auto value = read_value(item, names);
        plan.claims.push_back({value.pin, PinUse::kListens});
        spec.outputs.push_back(std::move(value));
    });
    if (plan.claims.empty()) {
        reader.fault("", "has neither \"inputs\" nor \"outputs\"");
        plan.claims.push_back({});
    }
    plan.make = maker<Values>(spec);
    return plan;
}

constexpr std::array kValuesVerbs{PartVerb{"set", "NAME=VALUE,...", "change what the board reads"}};

}  // namespace

const PartKind& values_part() {
    static constexpr PartKind kind{"values", kValuesVerbs, read_values};
    return kind;
}

}  // namespace asip::sim
