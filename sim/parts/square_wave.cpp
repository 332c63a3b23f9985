// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/parts/numbers.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& square_wave_part();

namespace {

/// A square-wave generator that drives a pin, for good or for a number of pulses. 0 Hz is a steady low.
struct SquareWaveSpec {
    int pin = 0;
    double hertz = 1;
};

constexpr double kHighestHertz = 1'000'000;
constexpr double kMostPulses = 1e9;

class SquareWave final : public Part {
  public:
    SquareWave(std::string name, const SquareWaveSpec& spec, PartContext& context)
        : Part(std::move(name), square_wave_part()),
          spec_(spec),
          context_(context),
          edge_(context.clock, [this] { toggle(); }) {
        start();
    }

    std::string state() const override { return short_number(spec_.hertz); }

  private:
    Expected<void> perform(std::string_view verb, std::string_view argument) override {
        if (verb == "burst") return burst(argument);
        const auto hertz = parse_number(argument);
        if (!hertz || *hertz < 0 || *hertz > kHighestHertz)
            return fail(
                fmt::format("a square-wave is set from 0 to {} Hz, not to \"{}\"", kHighestHertz, argument));
        if (*hertz == spec_.hertz && edges_left_ == 0) return {};
        edges_left_ = 0;
        spec_.hertz = *hertz;
        start();
        context_.changed(*this);
        return {};
    }

    Expected<void> burst(std::string_view argument) {
        const auto blank = std::min(argument.find(' '), argument.size());
        const double hertz = parse_number(argument.substr(0, blank)).value_or(0);
        const double pulses = parse_number(argument.substr(std::min(blank + 1, argument.size()))).value_or(0);
        if (hertz <= 0 || hertz > kHighestHertz || pulses < 1 || pulses > kMostPulses ||
            pulses != std::floor(pulses))
            return fail(fmt::format(
                "a burst is HERTZ (up to {}) and a whole number of PULSES (1 to {}), as in \"50 100\", "
                "not \"{}\"",
                kHighestHertz, kMostPulses, argument));
        spec_.hertz = hertz;
        edges_left_ = 2 * static_cast<std::uint64_t>(pulses);
        start();
        context_.changed(*this);
        return {};
    }

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
        if (edges_left_ == 0 || --edges_left_ > 0) return schedule();
        spec_.hertz = 0;
        context_.changed(*this);
    }

    void schedule() {
        // Kept exact: rounding must not shift the frequency.
        next_ += context_.cycles_per_us * 1e6 / spec_.hertz / 2;
        edge_.at(static_cast<std::uint64_t>(std::llround(next_)));
    }

    SquareWaveSpec spec_;
    PartContext& context_;
    Alarm edge_;
    double next_ = 0;
    std::uint64_t edges_left_ = 0;  // of a burst; 0: for good
    bool high_ = false;
};

PartPlan read_square_wave(PartReader& reader) {
    const SquareWaveSpec spec{reader.pin("pin"), reader.number("hertz", 1, 0, kHighestHertz)};
    return {.claims = {{spec.pin, PinUse::kDrives}}, .timers = 1, .make = maker<SquareWave>(spec)};
}

constexpr std::array kSquareWaveVerbs{
    PartVerb{"set", "HERTZ", "change the frequency of a generator"},
    PartVerb{"burst", "HERTZ PULSES", "so many pulses of a generator, then 0 Hz"}};

}  // namespace

const PartKind& square_wave_part() {
    static constexpr PartKind kind{"square-wave", kSquareWaveVerbs, read_square_wave};
    return kind;
}

}  // namespace asip::sim
