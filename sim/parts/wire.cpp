#include <fmt/format.h>

#include "sim/part_context.hpp"

namespace asip::sim {
namespace {

class Wire final : public Part {
  public:
    Wire(std::string name, const WireSpec& spec, PartContext& context)
        : Part(std::move(name)), spec_(spec), context_(context) {
        context.wiring.watch(spec.from, [this](PinState) { settle(); });
        context.wiring.watch(spec.to, [this](PinState) { settle(); });
        settle();
    }

    std::string_view kind() const override { return "wire"; }
    std::string state() const override { return connected_ ? "connected" : "cut"; }

    Expected<void> command(std::string_view verb, std::string_view) override {
        if (verb != "cut" && verb != "connect")
            return fail(fmt::format("a wire has no command \"{}\": cut, connect", verb));
        const bool connected = verb == "connect";
        if (connected == connected_) return {};
        connected_ = connected;
        settle();
        context_.changed(*this);
        return {};
    }

  private:
    void settle() {
        const auto from = context_.wiring.pin(spec_.from);
        const auto to = context_.wiring.pin(spec_.to);
        drive(spec_.to, drives_to_, connected_ && from.output && !to.output, from.high);
        drive(spec_.from, drives_from_, connected_ && to.output && !from.output, to.high);
    }

    void drive(int pin, bool& driving, bool wanted, bool high) {
        if (!wanted && !driving) return;
        driving = wanted;
        if (wanted)
            context_.wiring.drive(pin, high);
        else
            context_.wiring.release(pin);
    }

    WireSpec spec_;
    PartContext& context_;
    bool connected_ = true;
    bool drives_to_ = false;
    bool drives_from_ = false;
};

}  // namespace

std::unique_ptr<Part> make_part(const std::string& name, const WireSpec& spec, PartContext& context) {
    return std::make_unique<Wire>(name, spec, context);
}

}  // namespace asip::sim
