#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/part_context.hpp"

namespace asip::sim {
namespace {

constexpr double kPulseAt0 = 544;
constexpr double kPulseAt180 = 2400;
// Outside of these a servo sees no command in a pulse.
constexpr double kShortestPulse = 400;
constexpr double kLongestPulse = 2600;

class Servo final : public Part {
  public:
    Servo(std::string name, const ServoSpec& spec, PartContext& context)
        : Part(std::move(name)), context_(context) {
        context.wiring.watch(spec.pin, [this](PinState pin) { on_pin(pin); });
    }

    std::string_view kind() const override { return "servo"; }
    std::string state() const override { return angle_ ? std::to_string(*angle_) : "none"; }
    Expected<void> command(std::string_view verb, std::string_view) override {
        return fail(fmt::format("a servo has no command \"{}\": it only shows", verb));
    }

  private:
    void on_pin(PinState pin) {
        const auto now = context_.clock.cycle();
        if (pin.high) {
            if (!rose_at_) rose_at_ = now;
            return;
        }
        if (!rose_at_) return;
        const double pulse = static_cast<double>(now - *rose_at_) / context_.cycles_per_us;
        rose_at_.reset();
        if (pulse < kShortestPulse || pulse > kLongestPulse) return;
        const double angle = (pulse - kPulseAt0) / (kPulseAt180 - kPulseAt0) * 180;
        const int rounded = static_cast<int>(std::lround(std::clamp(angle, 0.0, 180.0)));
        if (angle_ == rounded) return;
        angle_ = rounded;
        context_.changed(*this);
    }

    PartContext& context_;
    std::optional<std::uint64_t> rose_at_;
    std::optional<int> angle_;
};

}  // namespace

std::unique_ptr<Part> make_part(const std::string& name, const ServoSpec& spec, PartContext& context) {
    return std::make_unique<Servo>(name, spec, context);
}

}  // namespace asip::sim
