// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <utility>

#include "sim/parts/numbers.hpp"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& registers_part();

namespace {

constexpr double kSettledUs = 5000;  // after the last byte, so that a change is one change

/// A number in hexadecimal that fills the text, up to `most`.
std::optional<unsigned> parse_hex(std::string_view text, unsigned most) {
    unsigned value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (fault != std::errc() || end != text.data() + text.size() || value > most) return std::nullopt;
    return value;
}

using Values = std::map<unsigned, unsigned>;  // by the number of a register

Expected<Values> parse_values(std::string_view text, unsigned width) {
    Values values;
    const unsigned most = width == 1 ? 0xff : 0xffff;
    for (const auto& [name, value] : assignments(text)) {
        const auto number = parse_hex(name, 0xff);
        const auto content = parse_hex(value, most);
        if (!number || !content)
            return fail(fmt::format("\"{}={}\" is no register and its value in hexadecimal, as 0F={:X}", name,
                                    value, most));
        values[*number] = *content;
    }
    return values;
}

struct RegistersSpec {
    std::uint8_t address = 0;
    unsigned width = 1;  ///< bytes of a register
    Values values;
};

/// Any chip on the I2C bus with numbered registers, of which each keeps what was written. It does nothing.
class Registers final : public Part, public I2cDevice {
  public:
    Registers(std::string name, const RegistersSpec& spec, PartContext& context)
        : Part(std::move(name), registers_part()),
          spec_(spec),
          context_(context),
          settled_(context.clock, [this] { look(); }) {
        context.i2c.attach(*this);
        power_on();
        shown_ = text();
    }

    std::string state() const override { return attached_ ? shown_ : "detached"; }
    std::uint8_t address() const override { return spec_.address; }
    bool is_there() const override { return attached_; }

    void started(bool reading) override {
        if (!reading) numbered_ = false;
        byte_ = 0;
    }
    bool write(std::uint8_t byte) override {
        if (!std::exchange(numbered_, true)) {
            number_ = byte;
            return true;
        }
        bytes_[place()] = byte;
        step();
        settled_.at(context_.clock.cycle() + static_cast<std::uint64_t>(kSettledUs * context_.cycles_per_us));
        return true;
    }
    std::uint8_t read() override {
        const auto byte = bytes_[place()];
        step();
        return byte;
    }

  private:
    std::size_t place() const { return std::size_t{number_} * spec_.width + byte_; }
    void step() {
        if (++byte_ < spec_.width) return;
        byte_ = 0;
        ++number_;
    }

    void power_on() {
        bytes_ = {};
        store(spec_.values);
    }
    void store(const Values& values) {
        for (const auto& [number, value] : values)
            for (unsigned i = 0; i < spec_.width; ++i)
                bytes_[std::size_t{number} * spec_.width + i] =
                    static_cast<std::uint8_t>(value >> 8 * (spec_.width - 1 - i));
    }

    std::string text() const {
        std::string text;
        for (unsigned number = 0; number < 256; ++number) {
            unsigned value = 0;
            for (unsigned i = 0; i < spec_.width; ++i)
                value = value << 8 | bytes_[std::size_t{number} * spec_.width + i];
            if (value != 0)
                text +=
                    fmt::format("{}{:02X}={:0{}X}", text.empty() ? "" : ",", number, value, 2 * spec_.width);
        }
        return text.empty() ? "0" : text;
    }
    void look() {
        auto now = text();
        if (now == shown_) return;
        shown_ = std::move(now);
        if (attached_) context_.changed(*this);
    }

    Expected<void> perform(std::string_view verb, std::string_view argument) override {
        if (verb == "set") {
            const auto values = parse_values(argument, spec_.width);
            if (!values) return fail(values.error());
            store(*values);
            look();
            return {};
        }
        const bool attached = verb == "attach";
        if (attached && !attached_) power_on();
        shown_ = text();
        if (std::exchange(attached_, attached) != attached) context_.changed(*this);
        return {};
    }

    RegistersSpec spec_;
    PartContext& context_;
    Alarm settled_;
    std::array<std::uint8_t, 512> bytes_{};
    std::string shown_;
    std::uint8_t number_ = 0;
    unsigned byte_ = 0;
    bool numbered_ = false, attached_ = true;
};

PartPlan read_registers(PartReader& reader) {
    RegistersSpec spec;
    spec.address = static_cast<std::uint8_t>(reader.number("address", 0x40, 0x08, 0x77));
    spec.width = static_cast<unsigned>(reader.number("width", 1, 1, 2));
    if (reader.has("values")) {
        const auto values = parse_values(reader.text("values"), spec.width);
        if (values)
            spec.values = *values;
        else
            reader.fault("values", values.error());
    }
    return {.claims = {{reader.sda(), PinUse::kBus}, {reader.scl(), PinUse::kBus}},
            .timers = 1,
            .make = maker<Registers>(spec)};
}

constexpr std::array kRegistersVerbs{
    PartVerb{"set", "REGISTER=VALUE,...", "change registers of a chip, in hexadecimal"},
    PartVerb{"detach", "", "take a chip off its bus"}, PartVerb{"attach", "", "put it back"}};

}  // namespace

const PartKind& registers_part() {
    static constexpr PartKind kind{"registers", kRegistersVerbs, read_registers};
    return kind;
}

}  // namespace asip::sim
