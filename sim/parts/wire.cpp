// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& wire_part();

namespace {

/// A wire between two pins: whichever is an output drives the other.
struct WireSpec {
    int from = 0;
    int to = 0;
};

class Wire final : public Part {
  public:
    Wire(std::string name, const WireSpec& spec, PartContext& context)
        : Part(std::move(name), wire_part()), spec_(spec), context_(context) {
        context.wiring.watch(spec.from, [this](PinState) { settle(); });
        context.wiring.watch(spec.to, [this](PinState) { settle(); });
        settle();
    }

    std::string state() const override { return connected_ ? "connected" : "cut"; }

  private:
    Expected<void> perform(std::string_view verb, std::string_view) override {
        const bool connected = verb == "connect";
        if (connected == connected_) return {};
        connected_ = connected;
        settle();
        context_.changed(*this);
        return {};
    }

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

PartPlan read_wire(PartReader& reader) {
    const WireSpec spec{reader.pin("from"), reader.pin("to")};
    return {.claims = {{spec.from, PinUse::kJoins}, {spec.to, PinUse::kJoins}}, .make = maker<Wire>(spec)};
}

constexpr std::array kWireVerbs{PartVerb{"cut", "", "take a wire away"},
                                PartVerb{"connect", "", "put a wire back"}};

}  // namespace

const PartKind& wire_part() {
    static constexpr PartKind kind{"wire", kWireVerbs, read_wire};
    return kind;
}

}  // namespace asip::sim
