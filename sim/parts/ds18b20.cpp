// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/parts/numbers.hpp"
#include "sim/parts/one_wire_device.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& ds18b20_part();

namespace {

constexpr double kMinDegrees = -55, kMaxDegrees = 125;
constexpr std::size_t kMaxDevices = 16;

// From the data sheet, in microseconds: a low of the board that is a reset, that is a 0, and that is a 1; for
// how long what a device sends is to be seen; when it says that it is there, and for how long; and a bit,
// with the pause behind it.
constexpr double kReset = 480, kZero = 60, kLongestZero = 120, kOne = 15;
constexpr double kSends = 15, kPresenceAfter = 30, kPresence = 120, kSlot = 61;

struct OneWireSpec {
    int pin = 0;
    bool parasite = false;
    std::vector<std::pair<std::uint64_t, double>> devices;  // serial number, degrees
};

/// Thermometers on one wire, with its resistor.
class OneWireLine final : public Part {
  public:
    OneWireLine(std::string name, const OneWireSpec& spec, PartContext& context)
        : Part(std::move(name), ds18b20_part()),
          pin_(spec.pin),
          context_(context),
          alarm_(context.clock, [this] { on_alarm(); }) {
        for (const auto& [number, degrees] : spec.devices)
            devices_.emplace_back(Ds18b20::id_of(number), degrees, spec.parasite);
        pull_down(false);
        context.wiring.watch(pin_, [this](PinState pin) { on_pin(pin.output && !pin.high); });
    }

    std::string state() const override {
        std::string text;
        for (const auto& device : devices_)
            text += (text.empty() ? "" : ",") + (device.attached ? short_number(device.degrees) : "detached");
        if (shorted_) text += " shorted";
        if (wrong_ > 0) text += fmt::format(" {} bits out of time", wrong_);
        if (cut_ > 0) text += fmt::format(" {} resets cut short", cut_);
        return text;
    }
    void after_reset() override { low_ = presence_ = false; }

  private:
    Expected<void> perform(std::string_view verb, std::string_view argument) override {
        const auto before = state();
        auto done =
            verb == "set" ? for_each(argument, kMinDegrees, kMaxDegrees,
                                     [](Ds18b20& device, double value) { device.degrees = value; })
            : verb == "damage"
                ? for_each(argument, 0, 1000,
                           [](Ds18b20& device, double value) { device.to_damage = static_cast<int>(value); })
            : verb == "short" || verb == "unshort" ? short_circuit(verb == "short")
                                                   : attach(verb == "attach", argument);
        if (!done) return done;
        if (state() != before) context_.changed(*this);
        return {};
    }

    Expected<void> short_circuit(bool on) {
        shorted_ = on;
        pull_down(false);
        return {};
    }

    Expected<void> attach(bool on, std::string_view argument) {
        const auto device = find(argument);
        if (!device) return fail(device.error());
        if (on && !(*device)->attached) (*device)->power_on();
        (*device)->attached = on;
        return {};
    }

    Expected<void> for_each(std::string_view argument, double low, double high,
                            const std::function<void(Ds18b20&, double)>& change) {
        for (const auto& [index, text] : assignments(argument)) {
            const auto device = find(index);
            if (!device) return fail(device.error());
            const auto value = parse_number(text);
            if (!value || *value < low || *value > high)
                return fail(fmt::format("{} is no number from {} to {}", text, low, high));
            change(**device, *value);
        }
        return {};
    }

    Expected<Ds18b20*> find(std::string_view index) {
        const auto number = parse_number(index);
        if (!number || *number < 0 || *number >= static_cast<double>(devices_.size()))
            return fail(
                fmt::format("there is no thermometer {}: they are 0 to {}", index, devices_.size() - 1));
        return &devices_[static_cast<std::size_t>(*number)];
    }

    void pull_down(bool on) { context_.wiring.drive(pin_, !on && !shorted_); }

    double now() const { return static_cast<double>(context_.clock.cycle()) / context_.cycles_per_us; }
    void wake_at(double microseconds) {
        alarm_.at(static_cast<std::uint64_t>(microseconds * context_.cycles_per_us));
    }

    void on_pin(bool low) {
        if (low == low_) return;
        low_ = low;
        if (low)
            fell();
        else
            rose(now() - fell_);
    }

    void fell() {
        if (now() - fell_ < kSlot || presence_) ++wrong_;
        fell_ = now();
        const bool held = std::any_of(devices_.begin(), devices_.end(),
                                      [](const Ds18b20& device) { return device.sends_low(); });
        if (!held) return;
        pull_down(true);
        wake_at(fell_ + kSends);
    }

    // Where a reset is cut short the data sheet leaves open what devices take it for. Here it is one, as for
    // real ones that need less.
    void rose(double lasted) {
        if (lasted > kLongestZero) {
            if (lasted < kReset) ++cut_;
            for (auto& device : devices_)
                device.reset();
            if (std::none_of(devices_.begin(), devices_.end(),
                             [](const Ds18b20& device) { return device.attached; }))
                return;
            presence_ = true;
            return wake_at(now() + kPresenceAfter);
        }
        const bool zero = lasted >= kZero, one = lasted <= kOne;
        if (!zero && !one) ++wrong_;
        for (auto& device : devices_)
            device.take_bit(one, now());
    }

    void on_alarm() {
        if (!presence_) return pull_down(false);
        if (announcing_) {
            presence_ = announcing_ = false;
            return pull_down(false);
        }
        announcing_ = true;
        pull_down(true);
        wake_at(now() + kPresence);
    }

    int pin_;
    PartContext& context_;
    Alarm alarm_;
    std::vector<Ds18b20> devices_;
    double fell_ = -1e9;
    bool low_ = false, shorted_ = false, presence_ = false, announcing_ = false;
    unsigned wrong_ = 0, cut_ = 0;
};

PartPlan read_ds18b20(PartReader& reader) {
    OneWireSpec spec;
    spec.pin = reader.pin("pin");
    spec.parasite = reader.flag("parasite");
    reader.each("devices", [&](PartReader& device) {
        const auto number =
            device.number("number", static_cast<double>(spec.devices.size() + 1), 0, 281474976710655.0);
        spec.devices.emplace_back(static_cast<std::uint64_t>(number),
                                  device.number("temperature", 20, kMinDegrees, kMaxDegrees));
    });
    if (spec.devices.empty()) spec.devices.emplace_back(1, 20);
    if (spec.devices.size() > kMaxDevices)
        reader.fault("devices", fmt::format("has more than {}", kMaxDevices));
    return {.claims = {{spec.pin, PinUse::kDrives}}, .timers = 1, .make = maker<OneWireLine>(spec)};
}

constexpr std::array kDs18b20Verbs{PartVerb{"set", "INDEX=DEGREES,...", "change what thermometers measure"},
                                   PartVerb{"damage", "INDEX=COUNT,...", "damage so many answers"},
                                   PartVerb{"detach", "INDEX", "take a thermometer off its wire"},
                                   PartVerb{"attach", "INDEX", "put it back"},
                                   PartVerb{"short", "", "connect the wire to ground"},
                                   PartVerb{"unshort", "", "connect it no longer"}};

}  // namespace

const PartKind& ds18b20_part() {
    static constexpr PartKind kind{"ds18b20", kDs18b20Verbs, read_ds18b20};
    return kind;
}

}  // namespace asip::sim
