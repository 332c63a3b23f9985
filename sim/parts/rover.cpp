// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>

#include "sim/parts/echo.hpp"
#include "sim/parts/numbers.hpp"
#include "sim/parts/servo_pulse.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"
#include "sim/world/picture.hpp"

namespace asip::sim {
namespace {

/// The encoder of a wheel: two pins whose signals are a quarter of a cycle apart, each edge at the moment at
/// which the wheel gets there. The first pin leads while the wheel turns forwards as it sees it. Needs a
/// timer of the simulator.
class WheelEncoder {
  public:
    WheelEncoder(PartContext& context, int first, int second, double cycles_per_radian);

    /// From now on the wheel turns evenly from where the last call ended to `turned` (radians), in `cycles`
    /// of the chip.
    void turn_to(double turned, std::uint64_t cycles);

  private:
    void put();
    void schedule();
    void edge();

    PartContext& context_;
    int first_;
    int second_;
    double quarters_per_radian_;
    Alarm next_;
    std::int64_t quarter_ = 0;  // shown by the pins
    double from_ = 0, to_ = 0;  // in quarters
    std::uint64_t began_ = 0;   // cycle
    std::uint64_t took_ = 1;    // cycles
};

WheelEncoder::WheelEncoder(PartContext& context, int first, int second, double cycles_per_radian)
    : context_(context),
      first_(first),
      second_(second),
      quarters_per_radian_(4 * cycles_per_radian),
      next_(context.clock, [this] { edge(); }) {
    put();
}

void WheelEncoder::put() {
    constexpr std::array<bool, 4> kFirst = {false, true, true, false}, kSecond = {false, false, true, true};
    const auto phase = static_cast<std::size_t>((quarter_ % 4 + 4) % 4);
    context_.wiring.drive(first_, kFirst[phase]);
    context_.wiring.drive(second_, kSecond[phase]);
}

void WheelEncoder::turn_to(double turned, std::uint64_t cycles) {
    // Edges of the time before that are still due: none is left out.
    while (std::floor(to_) != static_cast<double>(quarter_)) {
        quarter_ += std::floor(to_) > static_cast<double>(quarter_) ? 1 : -1;
        put();
    }
    from_ = to_;
    to_ = turned * quarters_per_radian_;
    began_ = context_.clock.cycle();
    took_ = cycles;
    schedule();
}

/// The next edge: where the wheel passes from one quarter into the next or the one before.
void WheelEncoder::schedule() {
    next_.cancel();
    if (std::floor(to_) == static_cast<double>(quarter_)) return;
    const double boundary = static_cast<double>(to_ > from_ ? quarter_ + 1 : quarter_);
    const double share = (boundary - from_) / (to_ - from_);
    next_.at(began_ + static_cast<std::uint64_t>(std::max(0.0, share) * static_cast<double>(took_)));
}

void WheelEncoder::edge() {
    quarter_ += to_ > from_ ? 1 : -1;
    put();
    schedule();
}

}  // namespace

const PartKind& rover_part();

namespace {

constexpr double kFloorMm = 100'000;

/// A two-wheeled robot in the world of its board. The pins are those of AsipMirto unless others are named.
struct RoverPins {
    std::vector<int> motors{8, 11, 5, 12, 13, 6};  ///< of each motor: forward, backward, power; left, right
    std::vector<int> encoders{3, 7, 2, 4};
    std::vector<int> bumps{9, 10};                 ///< left, right; low while pressed
    std::vector<int> reflectance{14, 17, 16, 15};  ///< emitters; left, middle, right: IR 0 is the right one
    int servo = 18;
    int distance = 19;  ///< an ultrasonic sensor with one pin, turned by the servo
    std::optional<world::Pose> pose;
    double start = 0;  ///< where there is no pose: millimetres along the line
};

/// The right wheel is mounted the other way round: forwards is backwards for its motor and encoder.
constexpr std::array<double, 2> kMounted = {1, -1};
constexpr double kAmbientMillivolts = 5000;  // without its emitters a sensor sees nothing come back
constexpr double kStepSeconds = 0.001;

class RoverPart final : public Part {
  public:
    RoverPart(std::string name, const RoverPins& pins, PartContext& context)
        : Part(std::move(name), rover_part()),
          pins_(pins),
          context_(context),
          world_(*context.world),
          rover_(pins.pose ? world_.add(*pins.pose) : world_.add_on_line(pins.start)),
          encoders_{WheelEncoder(context, pins.encoders[0], pins.encoders[1], cycles_per_radian()),
                    WheelEncoder(context, pins.encoders[2], pins.encoders[3], cycles_per_radian())},
          servo_(context, pins.servo, [] {}),
          sonar_(context, pins.distance, pins.distance, [this] { return distance_cm(); }),
          next_(context.clock, [this] { step(); }),
          due_(static_cast<double>(context.clock.cycle())) {
        context.wiring.watch(pins.reflectance[0], [this](PinState) { show_floor(); });
        show_floor();
        schedule();
    }

    std::string state() const override {
        const auto now = world_.state(rover_);
        return fmt::format("at {:.0f},{:.0f} heading {:.0f} laps {}{}{}", now.pose.at.x, now.pose.at.y,
                           world::degrees(now.pose.heading), now.laps, now.on_track ? "" : " off-track",
                           now.bumped[0] || now.bumped[1] ? " bumped" : "");
    }

  private:
    double cycles_per_radian() const { return world_.spec().rover.encoder_cycles / (2 * std::numbers::pi); }

    void schedule() {
        due_ += kStepSeconds * 1e6 * context_.cycles_per_us;
        next_.at(static_cast<std::uint64_t>(due_));
    }

    /// What the H-bridge of a motor is told: -1 to 1, its own forwards positive.
    double power(std::size_t motor) const {
        const auto* pins = &pins_.motors[3 * motor];
        const bool forward = is_high(pins[0]), backward = is_high(pins[1]);
        if (forward == backward) return 0;
        const auto duty = context_.wiring.pwm(pins[2]);
        const double amount = duty ? *duty / 255.0 : is_high(pins[2]) ? 1 : 0;
        return forward ? amount : -amount;
    }

    bool is_high(int pin) const {
        const auto state = context_.wiring.pin(pin);
        return state.output && state.high;
    }

    void step() {
        const auto happened =
            world_.step(rover_, kMounted[0] * power(0), kMounted[1] * power(1), kStepSeconds);
        const auto now = world_.state(rover_);
        schedule();
        const auto cycles = static_cast<std::uint64_t>(due_) - context_.clock.cycle();
        for (std::size_t i = 0; i < 2; ++i) {
            encoders_[i].turn_to(kMounted[i] * now.wheels[i].turned, cycles);
            show_bumper(pins_.bumps[i], now.bumped[i]);
        }
        if (is_high(pins_.reflectance[0])) show_floor();
        report(happened);
    }

    void show_bumper(int pin, bool pressed) {
        if (pressed == context_.wiring.is_pulled_low(pin)) return;
        if (pressed)
            context_.wiring.drive(pin, false);
        else
            context_.wiring.release(pin);
    }

    void show_floor() {
        const bool lit = is_high(pins_.reflectance[0]);
        if (!lit && !lit_) return;
        lit_ = lit;
        const auto values = world_.reflectance(rover_);
        for (std::size_t i = 0; i < 3; ++i)
            context_.wiring.set_millivolts(
                pins_.reflectance[i + 1],
                static_cast<int>(lit ? std::ceil(values[i] * 5000.0 / 1024) : kAmbientMillivolts));
    }

    std::optional<double> distance_cm() const {
        const double bearing = world::radians(servo_.angle().value_or(90) - 90);
        return world_.distance(rover_, bearing).value_or(kFloorMm) / 10;
    }

    void report(const world::World::Happened& what) {
        if (what.bump) context_.happened(*this, "bump");
        if (what.track.left) context_.happened(*this, "off-track");
        if (what.track.returned) context_.happened(*this, "on-track");
        if (what.track.lap)
            context_.happened(*this, fmt::format("lap {:.3f} rms {:.2f} max {:.2f}", what.track.lap->seconds,
                                                 what.track.lap->rms_mm, what.track.lap->max_mm));
    }

    Expected<void> perform(std::string_view verb, std::string_view argument) override {
        if (verb == "picture") return draw(std::string(argument));
        if (verb == "clear") {
            world_.clear();
            return {};
        }
        const auto numbers = three_numbers(argument);
        const bool block = verb == "block";
        if (!numbers || (block && (*numbers)[2] < 1))
            return fail(fmt::format("{} (up to {:.0f})",
                                    block ? "block needs x, y and a radius of at least 1 in millimetres: "
                                            "block rover 300 0 50"
                                          : "place needs x and y in millimetres and a heading in degrees: "
                                            "place rover 0 0 90",
                                    kFloorMm));
        const auto [x, y, last] = *numbers;
        if (block)
            world_.block({{x, y}, last});
        else
            world_.place(rover_, {{x, y}, world::radians(last)});
        context_.changed(*this);
        return {};
    }

    static std::optional<std::array<double, 3>> three_numbers(std::string_view text) {
        std::array<double, 3> numbers{};
        for (auto& number : numbers) {
            const auto end = std::min(text.find(' '), text.size());
            const auto value = parse_number(text.substr(0, end));
            if (!value || std::abs(*value) > kFloorMm) return std::nullopt;
            number = *value;
            text.remove_prefix(std::min(end + 1, text.size()));
        }
        if (!text.empty()) return std::nullopt;
        return numbers;
    }

    Expected<void> draw(const std::string& file) const {
        if (file.empty()) return fail("picture needs a file: picture rover lap.svg");
        if (!file.ends_with(".svg")) return fail(file + ": a picture is SVG, call it so: lap.svg");
        std::ofstream stream(file, std::ios::binary | std::ios::trunc);
        stream << world::picture(world_);
        stream.close();
        if (!stream) return fail(file + ": cannot be written");
        return {};
    }

    RoverPins pins_;
    PartContext& context_;
    world::World& world_;
    world::World::RoverId rover_;
    std::array<WheelEncoder, 2> encoders_;
    ServoPulse servo_;
    Echo sonar_;
    Alarm next_;
    double due_;  // cycle of the next step
    bool lit_ = true;
};

PartPlan read_rover_part(PartReader& reader) {
    reader.need_world();
    RoverPins pins;
    pins.motors = reader.pins("motors", pins.motors);
    pins.encoders = reader.pins("encoders", pins.encoders);
    pins.bumps = reader.pins("bumps", pins.bumps);
    pins.reflectance = reader.pins("reflectance", pins.reflectance);
    if (reader.has("servo")) pins.servo = reader.pin("servo");
    if (reader.has("distance")) pins.distance = reader.pin("distance");
    pins.start = reader.number("start", 0, -kFloorMm, kFloorMm);
    if (reader.has("x") || reader.has("y"))
        pins.pose = world::Pose{
            {reader.number("x", 0, -kFloorMm, kFloorMm), reader.number("y", 0, -kFloorMm, kFloorMm)},
            world::radians(reader.number("heading", 0, -360, 360))};
    PartPlan plan{.claims = {}, .timers = 4, .make = maker<RoverPart>(pins)};
    const auto claim = [&](const std::vector<int>& list, PinUse use) {
        for (const int pin : list)
            plan.claims.push_back({pin, use});
    };
    claim(pins.motors, PinUse::kListens);
    claim(pins.encoders, PinUse::kDrives);
    claim(pins.bumps, PinUse::kDrives);
    plan.claims.push_back({pins.reflectance[0], PinUse::kListens});
    for (std::size_t i = 1; i < pins.reflectance.size(); ++i)
        plan.claims.push_back({pins.reflectance[i], PinUse::kDrives, true});
    plan.claims.push_back({pins.servo, PinUse::kListens});
    plan.claims.push_back({pins.distance, PinUse::kDrives});
    return plan;
}

constexpr std::array kRoverVerbs{
    PartVerb{"place", "X Y HEADING", "put a rover down: millimetres, degrees counter-clockwise"},
    PartVerb{"block", "X Y RADIUS", "put a round obstacle into the world of a rover: millimetres"},
    PartVerb{"clear", "", "take all obstacles out of the world of a rover"},
    PartVerb{"picture", "FILE", "draw the world of a rover and the ways of all in it, as SVG"}};

}  // namespace

const PartKind& rover_part() {
    static constexpr PartKind kind{"rover", kRoverVerbs, read_rover_part};
    return kind;
}

}  // namespace asip::sim
