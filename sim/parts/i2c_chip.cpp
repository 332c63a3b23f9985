// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/i2c_chip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/parts/numbers.hpp"

namespace asip::sim {

I2cChip::I2cChip(std::string name, const PartKind& kind, std::uint8_t address,
                 std::span<const Quantity> quantities, std::vector<double> values, PartContext& context)
    : Part(std::move(name), kind),
      context_(context),
      address_(address),
      quantities_(quantities),
      values_(std::move(values)) {
    context.i2c.attach(*this);
}

std::string I2cChip::state() const {
    if (!attached_) return "detached";
    std::string text;
    for (const auto value : values_)
        text += (text.empty() ? "" : ",") + short_number(value);
    return text;
}

void I2cChip::started(bool reading) {
    if (!reading) numbered_ = false;
}

bool I2cChip::write(std::uint8_t byte) {
    const auto number = register_;
    if (!numbered_)
        register_ = byte;
    else if (steps())
        ++register_;
    if (std::exchange(numbered_, true)) write_register(number, byte);
    return true;
}

std::uint8_t I2cChip::byte_of(std::size_t index, unsigned byte) const {
    const auto value = static_cast<unsigned>(std::lround(values_[index]));
    return static_cast<std::uint8_t>(byte == 0 ? value >> 8 : value);
}

Expected<void> I2cChip::perform(std::string_view verb, std::string_view argument) {
    const auto before = state();
    if (verb == "set") {
        if (auto done = set(argument); !done) return done;
    } else {
        attached_ = verb == "attach";
        if (attached_) power_on();
    }
    if (state() != before) context_.changed(*this);
    return {};
}

Expected<void> I2cChip::set(std::string_view argument) {
    auto values = values_;
    for (const auto& [name, text] : assignments(argument)) {
        const auto found =
            std::find_if(quantities_.begin(), quantities_.end(),
                         [&, wanted = name](const Quantity& quantity) { return quantity.name == wanted; });
        if (found == quantities_.end()) {
            std::string names;
            for (const auto& quantity : quantities_)
                names += fmt::format("{}{}", names.empty() ? "" : ", ", quantity.name);
            return fail(fmt::format("{} has no \"{}\": {}", kind().name, name, names));
        }
        const auto value = parse_number(text);
        if (!value || *value < found->min || *value > found->max)
            return fail(fmt::format("{} is a number from {} to {}", found->name, found->min, found->max));
        values[static_cast<std::size_t>(found - quantities_.begin())] = *value;
    }
    values_ = std::move(values);
    values_changed();
    return {};
}

std::vector<double> read_quantities(PartReader& reader, std::span<const Quantity> quantities) {
    std::vector<double> values;
    for (const auto& quantity : quantities)
        values.push_back(reader.number(quantity.name, quantity.otherwise, quantity.min, quantity.max));
    return values;
}

}  // namespace asip::sim
