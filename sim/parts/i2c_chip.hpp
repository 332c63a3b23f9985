// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>
#include <vector>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

/// Something that a sensor measures, settable in a board file and by `set NAME=VALUE`.
struct Quantity {
    const char* name;
    double otherwise;  ///< where a board file says nothing
    double min, max;
};

/// A chip on the I2C bus that has registers of a byte each: the first byte written to it is the number of a
/// register, which steps on with each byte written or read.
class I2cChip : public Part, public I2cDevice {
  public:
    /// The quantities in their order: "0,0,16384", or "detached".
    std::string state() const override;

    std::uint8_t address() const override { return address_; }
    bool is_there() const override { return attached_; }
    void started(bool reading) override;
    bool write(std::uint8_t byte) override;
    std::uint8_t read() override {
        const auto number = register_;
        if (steps()) ++register_;
        return read_register(number);
    }

    static constexpr std::array kVerbs{PartVerb{"set", "NAME=VALUE,...", "change what a sensor measures"},
                                       PartVerb{"detach", "", "take a chip off its bus"},
                                       PartVerb{"attach", "", "put it back"}};

  protected:
    I2cChip(std::string name, const PartKind& kind, std::uint8_t address,
            std::span<const Quantity> quantities, std::vector<double> values, PartContext& context);

    virtual std::uint8_t read_register(std::uint8_t number) = 0;
    virtual void write_register(std::uint8_t number, std::uint8_t value) = 0;
    /// Whether the number of the register steps on behind each byte.
    virtual bool steps() const { return true; }
    /// It was attached again: back to what it is when power comes.
    virtual void power_on() = 0;
    /// What is measured has changed.
    virtual void values_changed() {}

    double value(std::size_t index) const { return values_[index]; }
    /// As two bytes, the higher first: byte 0 or 1.
    std::uint8_t byte_of(std::size_t index, unsigned byte) const;
    PartContext& context() { return context_; }
    Expected<void> perform(std::string_view verb, std::string_view argument) override;

  private:
    Expected<void> set(std::string_view argument);

    PartContext& context_;
    std::uint8_t address_;
    std::span<const Quantity> quantities_;
    std::vector<double> values_;
    bool attached_ = true;
    bool numbered_ = false;
    std::uint8_t register_ = 0;
};

/// The quantities as a board file has them.
std::vector<double> read_quantities(PartReader& reader, std::span<const Quantity> quantities);

/// The smallest raw value from `low` to `high` whose measure is not below the wanted one.
template <class Measure>
long raw_of(long low, long high, double wanted, Measure measure) {
    while (low < high) {
        const long middle = (low + high) / 2;
        if (static_cast<double>(measure(middle)) < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// The plan of a part on the bus, made with `options`; it has no pins of its own.
template <class Made, class... Options>
PartPlan read_i2c_chip(PartReader& reader, std::span<const Quantity> quantities, Options... options) {
    auto values = read_quantities(reader, quantities);
    return {.claims = {{reader.sda(), PinUse::kBus}, {reader.scl(), PinUse::kBus}},
            .timers = 1,
            .make = [values = std::move(values), options...](std::string name,
                                                             PartContext& context) -> std::unique_ptr<Part> {
                return std::make_unique<Made>(std::move(name), options..., values, context);
            }};
}

}  // namespace asip::sim
