#include <fmt/format.h>

#include <cmath>

#include "sim/part_context.hpp"
#include "sim/parts/numbers.hpp"

namespace asip::sim {
namespace {

constexpr double kHighestHertz = 1'000'000;

class SquareWave final : public Part {
  public:
    SquareWave(std::string name, const SquareWaveSpec& spec, PartContext& context)
        : Part(std::move(name)), spec_(spec), context_(context), edge_(context.clock, [this] { toggle(); }) {
        start();
    }

    std::string_view kind() const override { return "square-wave"; }
    std::string state() const override { return short_number(spec_.hertz); }

    Expected<void> command(std::string_view verb, std::string_view argument) override {
        if (verb != "set") return fail(fmt::format("a square-wave has no command \"{}\": set HERTZ", verb));
        const auto hertz = parse_number(argument);
        if (!hertz || *hertz < 0 || *hertz > kHighestHertz)
            return fail(
                fmt::format("a square-wave is set from 0 to {} Hz, not to \"{}\"", kHighestHertz, argument));
        if (*hertz == spec_.hertz) return {};
        spec_.hertz = *hertz;
        start();
        context_.changed(*this);
        return {};
    }

  private:
    void start() {
        high_ = false;
        context_.wiring.drive(spec_.pin, false);
        edge_.cancel();
        if (spec_.hertz <= 0) return;
        next_ = static_cast<double>(context_.clock.cycle());
        schedule();
    }

    void toggle() {
        high_ = !high_;
        context_.wiring.drive(spec_.pin, high_);
        schedule();
    }

    void schedule() {
        next_ += context_.cycles_per_us * 1e6 / spec_.hertz /
                 2;  // kept exact: rounding must not shift the frequency
        edge_.at(static_cast<std::uint64_t>(std::llround(next_)));
    }

    SquareWaveSpec spec_;
    PartContext& context_;
    Alarm edge_;
    double next_ = 0;
    bool high_ = false;
};

}  // namespace

std::unique_ptr<Part> make_part(const std::string& name, const SquareWaveSpec& spec, PartContext& context) {
    return std::make_unique<SquareWave>(name, spec, context);
}

}  // namespace asip::sim
