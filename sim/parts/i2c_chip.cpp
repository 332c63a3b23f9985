#include "sim/parts/i2c_chip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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
    if (numbered_)
        write_register(register_++, byte);
    else
        register_ = byte;
    numbered_ = true;
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
    while (!argument.empty()) {
        const auto comma = std::min(argument.find(','), argument.size());
        const auto item = argument.substr(0, comma);
        argument.remove_prefix(std::min(comma + 1, argument.size()));
        const auto equals = std::min(item.find('='), item.size());
        const auto found =
            std::find_if(quantities_.begin(), quantities_.end(),
                         [&](const Quantity& quantity) { return quantity.name == item.substr(0, equals); });
        if (found == quantities_.end()) {
            std::string names;
            for (const auto& quantity : quantities_)
                names += fmt::format("{}{}", names.empty() ? "" : ", ", quantity.name);
            return fail(fmt::format("{} has no \"{}\": {}", kind().name, item.substr(0, equals), names));
        }
        const auto value = parse_number(item.substr(std::min(equals + 1, item.size())));
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
