#include <fmt/format.h>

#include "sim/part_context.hpp"

namespace asip::sim {
namespace {

class Led final : public Part {
  public:
    Led(std::string name, const LedSpec& spec, PartContext& context)
        : Part(std::move(name)), spec_(spec), context_(context), state_(look()) {
        context.wiring.watch(spec.pin, [this](PinState) { update(); });
        context.wiring.watch_pwm(spec.pin, [this] { update(); });
    }

    std::string_view kind() const override { return "led"; }
    std::string state() const override { return state_; }
    Expected<void> command(std::string_view verb, std::string_view) override {
        return fail(fmt::format("an led has no command \"{}\": it only shows", verb));
    }

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

}  // namespace

std::unique_ptr<Part> make_part(const std::string& name, const LedSpec& spec, PartContext& context) {
    return std::make_unique<Led>(name, spec, context);
}

}  // namespace asip::sim
