// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "sim/parts/numbers.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& dht_part();

namespace {

/// A DHT11 or DHT22 with the resistor that holds its line high.
struct DhtSpec {
    int pin = 0;
    bool dht11 = false;
    double temperature = 20;
    double humidity = 50;
};

// From the data sheets of DHT11 and AM2302, in microseconds.
struct Times {
    double wake;                        // the shortest low of the host that is heard
    double wait, low, high;             // before the answer, and at its beginning
    double bit_low, bit_zero, bit_one;  // a bit
    double end;                         // the low behind the last bit
};
constexpr Times kAm2302Times{800, 30, 80, 80, 50, 26, 70, 50};
constexpr Times kDht11Times{18000, 30, 83, 87, 54, 24, 71, 54};
constexpr double kRestUs = 2e6;  // between two questions; one that comes sooner is not answered
constexpr std::size_t kBits = 40;

class Dht final : public Part {
  public:
    Dht(std::string name, const DhtSpec& spec, PartContext& context)
        : Part(std::move(name), dht_part()),
          spec_(spec),
          times_(spec.dht11 ? kDht11Times : kAm2302Times),
          context_(context),
          next_(context.clock, [this] { step(); }) {
        context.wiring.drive(spec.pin, true);
        context.wiring.watch(spec.pin, [this](PinState pin) { on_pin(pin); });
        measured_ = frame();
    }

    std::string state() const override {
        if (!attached_) return "detached";
        return short_number(spec_.temperature) + "," + short_number(spec_.humidity);
    }
    void after_reset() override {
        low_since_.reset();
        step_ = 0;
    }

  private:
    using Frame = std::array<std::uint8_t, 5>;

    Expected<void> perform(std::string_view verb, std::string_view argument) override {
        const auto before = state();
        if (verb == "set") {
            if (auto done = set(argument); !done) return done;
        } else if (verb == "damage") {
            const auto count = parse_number(argument);
            if (!count || *count < 0 || *count > 1000)
                return fail("a number of answers from 0 to 1000 is damaged");
            to_damage_ = static_cast<int>(*count);
        } else {
            attached_ = verb == "attach";
            if (attached_) measured_ = frame();
        }
        if (state() != before) context_.changed(*this);
        return {};
    }

    Expected<void> set(std::string_view argument) {
        auto spec = spec_;
        for (const auto& [name, text] : assignments(argument)) {
            const auto value = parse_number(text);
            if (name != "temperature" && name != "humidity")
                return fail(fmt::format("a dht has no \"{}\": temperature, humidity", name));
            const bool humid = name == "humidity";
            const double low = humid ? 0 : -40, high = humid ? 100 : 80;
            if (!value || *value < low || *value > high)
                return fail(fmt::format("{} is a number from {} to {}", name, low, high));
            (humid ? spec.humidity : spec.temperature) = *value;
        }
        spec_ = spec;
        return {};
    }

    /// What is measured now, as it is sent.
    Frame frame() const {
        const auto magnitude = static_cast<unsigned>(std::lround(std::fabs(spec_.temperature) * 10));
        const bool negative = spec_.temperature < 0 && magnitude != 0;
        const auto humidity = static_cast<unsigned>(std::lround(spec_.humidity * 10));
        std::array<unsigned, 4> bytes{};
        if (spec_.dht11)
            bytes = {humidity / 10, humidity % 10, magnitude / 10, magnitude % 10 + (negative ? 128u : 0u)};
        else
            bytes = {humidity >> 8, humidity, (magnitude >> 8) + (negative ? 128u : 0u), magnitude};
        Frame result{};
        unsigned sum = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            result[i] = static_cast<std::uint8_t>(bytes[i]);
            sum += result[i];
        }
        result[4] = static_cast<std::uint8_t>(sum);
        return result;
    }

    void on_pin(PinState pin) {
        if (!attached_ || step_ != 0) return;
        const auto now = context_.clock.cycle();
        if (pin.output && !pin.high) {
            if (!low_since_) low_since_ = now;
            return;
        }
        if (!low_since_) return;
        const bool heard = static_cast<double>(now - *low_since_) >= cycles(times_.wake);
        low_since_.reset();
        if (!heard || static_cast<double>(now) < cycles(kRestUs) + static_cast<double>(answered_)) return;
        answered_ = now;
        sent_ = measured_;
        measured_ = frame();  // a sensor tells what it measured when it was asked before
        if (to_damage_ > 0) {
            --to_damage_;
            sent_[3] ^= 1;
        }
        step_ = 1;
        at_ = static_cast<double>(now) + cycles(times_.wait);
        next_.at(static_cast<std::uint64_t>(at_));
    }

    /// The end of each step; from 3 on, a low and a high for each bit.
    void step() {
        if (!attached_) step_ = 2 * kBits + 4;
        const bool low = step_ % 2 == 1;
        context_.wiring.drive(spec_.pin, !low);
        if (step_ >= 2 * kBits + 4) {
            step_ = 0;
            return;
        }
        at_ += cycles(duration(low));
        next_.at(static_cast<std::uint64_t>(at_));
        ++step_;
    }

    double duration(bool low) const {
        if (step_ == 1) return times_.low;
        if (step_ == 2) return times_.high;
        if (step_ == 2 * kBits + 3) return times_.end;
        if (low) return times_.bit_low;
        const auto bit = (step_ - 4) / 2;
        return (sent_[bit / 8] >> (7 - bit % 8) & 1) != 0 ? times_.bit_one : times_.bit_zero;
    }

    double cycles(double microseconds) const { return microseconds * context_.cycles_per_us; }

    DhtSpec spec_;
    Times times_;
    PartContext& context_;
    Alarm next_;
    Frame measured_{}, sent_{};
    std::optional<std::uint64_t> low_since_;
    std::uint64_t answered_ = 0;
    double at_ = 0;
    std::size_t step_ = 0;
    int to_damage_ = 0;
    bool attached_ = true;
};

PartPlan read_dht(PartReader& reader) {
    DhtSpec spec;
    spec.pin = reader.pin("pin");
    spec.dht11 = reader.flag("dht11");
    spec.temperature = reader.number("temperature", spec.temperature, -40, 80);
    spec.humidity = reader.number("humidity", spec.humidity, 0, 100);
    return {.claims = {{spec.pin, PinUse::kDrives}}, .timers = 1, .make = maker<Dht>(spec)};
}

constexpr std::array kDhtVerbs{PartVerb{"set", "NAME=VALUE,...", "change what a sensor measures"},
                               PartVerb{"damage", "COUNT", "damage so many answers of a sensor"},
                               PartVerb{"detach", "", "take a sensor off its pin"},
                               PartVerb{"attach", "", "put it back"}};

}  // namespace

const PartKind& dht_part() {
    static constexpr PartKind kind{"dht", kDhtVerbs, read_dht};
    return kind;
}

}  // namespace asip::sim
