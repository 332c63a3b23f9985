// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& button_part();

namespace {

/// A push button to ground, open when released (the sketch uses a pull-up); with `to_vcc` it connects to VCC
/// and has a pull-down of its own. Its contact bounces, as contacts do, unless it is `steady`.
struct ButtonSpec {
    int pin = 0;
    bool to_vcc = false;
    bool steady = false;
};

/// When the contact is the other way round for a moment, and when it is back, after it closed or opened.
constexpr std::array kBouncesUs{400.0, 900.0, 2000.0, 3100.0};

class Button final : public Part {
  public:
    Button(std::string name, const ButtonSpec& spec, PartContext& context)
        : Part(std::move(name), button_part()),
          spec_(spec),
          context_(context),
          next_(context.clock, [this] { bounce(); }) {
        connect(pressed_);
    }

    std::string state() const override { return pressed_ ? "pressed" : "released"; }

  private:
    Expected<void> perform(std::string_view verb, std::string_view) override {
        const bool pressed = verb == "press";
        if (pressed == pressed_) return {};
        pressed_ = pressed;
        connect(pressed_);
        moved_at_ = context_.clock.cycle();
        bounces_ = 0;
        if (!spec_.steady) wait();
        context_.changed(*this);
        return {};
    }

    void wait() {
        next_.at(moved_at_ + static_cast<std::uint64_t>(kBouncesUs[bounces_] * context_.cycles_per_us));
    }

    void bounce() {
        const bool apart = ++bounces_ % 2 == 1;
        connect(pressed_ != apart);
        if (bounces_ < kBouncesUs.size()) wait();
    }

    void connect(bool closed) {
        if (spec_.to_vcc)
            context_.wiring.drive(spec_.pin, closed);
        else if (closed)
            context_.wiring.drive(spec_.pin, false);
        else
            context_.wiring.release(spec_.pin);
    }

    ButtonSpec spec_;
    PartContext& context_;
    Alarm next_;
    bool pressed_ = false;
    std::uint64_t moved_at_ = 0;
    std::size_t bounces_ = 0;
};

PartPlan read_button(PartReader& reader) {
    const ButtonSpec spec{reader.pin("pin"), reader.flag("to_vcc"), reader.flag("steady")};
    return {.claims = {{spec.pin, PinUse::kDrives}}, .timers = 1, .make = maker<Button>(spec)};
}

constexpr std::array kButtonVerbs{PartVerb{"press", "", "press a button and hold it"},
                                  PartVerb{"release", "", "release a button"}};

}  // namespace

const PartKind& button_part() {
    static constexpr PartKind kind{"button", kButtonVerbs, read_button};
    return kind;
}

}  // namespace asip::sim
