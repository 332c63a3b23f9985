#include <fmt/format.h>

#include "sim/part_context.hpp"

namespace asip::sim {
namespace {

class Button final : public Part {
  public:
    Button(std::string name, const ButtonSpec& spec, PartContext& context)
        : Part(std::move(name)), spec_(spec), context_(context) {
        connect();
    }

    std::string_view kind() const override { return "button"; }
    std::string state() const override { return pressed_ ? "pressed" : "released"; }

    Expected<void> command(std::string_view verb, std::string_view) override {
        if (verb != "press" && verb != "release")
            return fail(fmt::format("a button has no command \"{}\": press, release", verb));
        const bool pressed = verb == "press";
        if (pressed == pressed_) return {};
        pressed_ = pressed;
        connect();
        context_.changed(*this);
        return {};
    }

  private:
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

}  // namespace

std::unique_ptr<Part> make_part(const std::string& name, const ButtonSpec& spec, PartContext& context) {
    return std::make_unique<Button>(name, spec, context);
}

}  // namespace asip::sim
