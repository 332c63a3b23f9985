#include <fmt/format.h>

#include <cmath>

#include "sim/part_context.hpp"
#include "sim/parts/numbers.hpp"

namespace asip::sim {
namespace {

constexpr double kSupplyMillivolts = 5000;

class Potentiometer final : public Part {
  public:
    Potentiometer(std::string name, const PotentiometerSpec& spec, PartContext& context)
        : Part(std::move(name)), spec_(spec), context_(context) {
        apply();
    }

    std::string_view kind() const override { return "potentiometer"; }
    std::string state() const override { return short_number(spec_.position); }

    Expected<void> command(std::string_view verb, std::string_view argument) override {
        if (verb != "set") return fail(fmt::format("a potentiometer has no command \"{}\": set 0..1", verb));
        const auto position = parse_number(argument);
        if (!position || *position < 0 || *position > 1)
            return fail(fmt::format("a potentiometer is set from 0 to 1, not to \"{}\"", argument));
        if (*position == spec_.position) return {};
        spec_.position = *position;
        apply();
        context_.changed(*this);
        return {};
    }

    void after_reset() override { apply(); }

  private:
    void apply() {
        context_.wiring.set_millivolts(spec_.pin,
                                       static_cast<int>(std::lround(spec_.position * kSupplyMillivolts)));
    }

    PotentiometerSpec spec_;
    PartContext& context_;
};

}  // namespace

std::unique_ptr<Part> make_part(const std::string& name, const PotentiometerSpec& spec,
                                PartContext& context) {
    return std::make_unique<Potentiometer>(name, spec, context);
}

}  // namespace asip::sim
