// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& button_part();

namespace {

/// A push button to ground, open when released (the sketch uses a pull-up); with `to_vcc` it connects to VCC
/// and has a pull-down of its own.
struct ButtonSpec {
    int pin = 0;
    bool to_vcc = false;
};

class Button final : public Part {
  public:
    Button(std::string name, const ButtonSpec& spec, PartContext& context)
        : Part(std::move(name), button_part()), spec_(spec), context_(context) {
        connect();
    }

    std::string state() const override { return pressed_ ? "pressed" : "released"; }

  private:
    Expected<void> perform(std::string_view verb, std::string_view) override {
        const bool pressed = verb == "press";
        if (pressed == pressed_) return {};
        pressed_ = pressed;
        connect();
        context_.changed(*this);
        return {};
    }

    void connect() {
        if (spec_.to_vcc)
            context_.wiring.drive(spec_.pin, pressed_);
        else if (pressed_)
            context_.wiring.drive(spec_.pin, false);
        else
            context_.wiring.release(spec_.pin);
    }

    ButtonSpec spec_;
    PartContext& context_;
    bool pressed_ = false;
};

PartPlan read_button(PartReader& reader) {
    const ButtonSpec spec{reader.pin("pin"), reader.flag("to_vcc")};
    return {.claims = {{spec.pin, PinUse::kDrives}}, .make = maker<Button>(spec)};
}

constexpr std::array kButtonVerbs{PartVerb{"press", "", "press a button and hold it"},
                                  PartVerb{"release", "", "release a button"}};

}  // namespace

const PartKind& button_part() {
    static constexpr PartKind kind{"button", kButtonVerbs, read_button};
    return kind;
}

}  // namespace asip::sim
