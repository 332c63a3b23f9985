// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& led_part();

namespace {

/// An LED to ground (lit by a high pin), or to VCC with `active_low`.
struct LedSpec {
    int pin = 0;
    bool active_low = false;
};

class Led final : public Part {
  public:
    Led(std::string name, const LedSpec& spec, PartContext& context)
        : Part(std::move(name), led_part()), spec_(spec), context_(context), state_(look()) {
        context.wiring.watch(spec.pin, [this](PinState) { update(); });
        context.wiring.watch_pwm(spec.pin, [this] { update(); });
    }

    std::string state() const override { return state_; }

  private:
    std::string look() const {
        const auto pin = context_.wiring.pin(spec_.pin);
        if (!pin.output) return "off";
        if (const auto duty = context_.wiring.pwm(spec_.pin))
            return fmt::format("pwm {}", spec_.active_low ? 255 - *duty : *duty);
        return pin.high != spec_.active_low ? "on" : "off";
    }

    void update() {
        auto now = look();
        if (now == state_) return;
        state_ = std::move(now);
        context_.changed(*this);
    }

    LedSpec spec_;
    PartContext& context_;
    std::string state_;
};

PartPlan read_led(PartReader& reader) {
    const LedSpec spec{reader.pin("pin"), reader.flag("active_low")};
    return {.claims = {{spec.pin, PinUse::kListens}}, .make = maker<Led>(spec)};
}

}  // namespace

const PartKind& led_part() {
    static constexpr PartKind kind{"led", {}, read_led};
    return kind;
}

}  // namespace asip::sim
