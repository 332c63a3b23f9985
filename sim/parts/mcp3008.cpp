// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sim/parts/numbers.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& mcp3008_part();

namespace {

constexpr double kReference = 5;  // volts

struct Mcp3008Spec {
    int select = 0;
    std::array<double, 8> volts{};
};

/// From the data sheet of the MCP3008: eight voltages in 10 bits, on the chip's SPI. Behind the start bit
/// come four that choose, one in which it samples, and a 0.
class Mcp3008 final : public Part {
  public:
    Mcp3008(std::string name, const Mcp3008Spec& spec, PartContext& context)
        : Part(std::move(name), mcp3008_part()), volts_(spec.volts), context_(context) {
        auto& avr = context.clock.avr();
        input_ = avr_io_getirq(&avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_INPUT);
        avr_irq_register_notify(avr_io_getirq(&avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_OUTPUT), on_byte, this);
        context.wiring.watch(spec.select, [this](PinState pin) {
            chosen_ = pin.output && !pin.high;
            bits_ = -1;
        });
    }

    std::string state() const override {
        std::string text;
        for (const auto volts : volts_)
            text += (text.empty() ? "" : ",") + short_number(volts);
        return text;
    }

  private:
    static void on_byte(avr_irq_t*, std::uint32_t value, void* param) {
        auto& self = *static_cast<Mcp3008*>(param);
        if (self.chosen_) avr_raise_irq(self.input_, self.exchange(value));
    }
    std::uint32_t exchange(std::uint32_t byte) {
        std::uint32_t sent = 0;
        for (int bit = 7; bit >= 0; --bit)
            sent = sent << 1 | clock(byte >> bit & 1);
        return sent;
    }
    std::uint32_t clock(std::uint32_t in) {
        if (bits_ < 0) {
            if (in == 1) bits_ = choice_ = 0;
            return 0;
        }
        if (++bits_ <= 4) choice_ = static_cast<int>(static_cast<std::uint32_t>(choice_) << 1 | in);
        return bits_ >= 7 && bits_ <= 16 ? measured() >> (16 - bits_) & 1 : 0;
    }
    std::uint32_t measured() const {
        const auto channel = static_cast<std::size_t>(choice_ & 7);
        const double volts = (choice_ & 8) != 0 ? volts_[channel] : volts_[channel] - volts_[channel ^ 1];
        return static_cast<std::uint32_t>(std::min(1023.0, std::max(0.0, volts / kReference * 1024)));
    }

    Expected<void> perform(std::string_view, std::string_view argument) override {
        auto volts = volts_;
        for (const auto& [name, text] : assignments(argument)) {
            const auto value = parse_number(text);
            if (name.size() != 1 || name[0] < '0' || name[0] > '7' || !value || *value < 0 ||
                *value > kReference)
                return fail("an input is 0 to 7, and its volts are a number from 0 to 5: 0=1.25");
            volts[static_cast<std::size_t>(name[0] - '0')] = *value;
        }
        volts_ = volts;
        context_.changed(*this);
        return {};
    }

    std::array<double, 8> volts_;
    PartContext& context_;
    avr_irq_t* input_ = nullptr;
    bool chosen_ = false;
    int bits_ = -1;  // behind the start bit
    int choice_ = 0;
};

PartPlan read_mcp3008(PartReader& reader) {
    Mcp3008Spec spec{reader.pin("select"), {}};
    for (std::size_t i = 0; i < spec.volts.size(); ++i)
        spec.volts[i] = reader.number(fmt::format("v{}", i), 0, 0, kReference);
    return {.claims = {{spec.select, PinUse::kListens}}, .make = maker<Mcp3008>(spec)};
}

constexpr std::array kVerbs{PartVerb{"set", "INPUT=VOLTS,...", "change what a sensor measures"}};

}  // namespace

const PartKind& mcp3008_part() {
    static constexpr PartKind kind{"mcp3008", kVerbs, read_mcp3008};
    return kind;
}

}  // namespace asip::sim
