// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/pin_entities.hpp"

#include <algorithm>

#include "asip/protocol/pin.hpp"

namespace asip::gateway::exports {
namespace {

using protocol::PinMode;

constexpr double kMaxDuty = 255;
constexpr double kMaxAnalog = 1023;
constexpr auto kOutput = static_cast<double>(PinMode::kOutput);

char at(const std::string& text, std::size_t pin, char otherwise) {
    return pin < text.size() ? text[pin] : otherwise;
}

PinMode mode_of(const model::PinsInfo& pins, std::size_t pin) {
    return protocol::pin_mode_from_number(at(pins.modes, pin, '0') - '0').value_or(PinMode::kInvalid);
}

/// Nothing: the pin has no analog channel.
std::optional<int> channel_of(const model::PinsInfo& pins, std::size_t pin) {
    for (const auto& [digital, channel] : pins.analog)
        if (digital == pin) return channel;
    return std::nullopt;
}

void make_levels(Entity& entity) {
    entity.whole = true;
    entity.options = {{"off", 0}, {"on", 1}};
}

void make_switch(Entity& entity, const std::string& io, double pin) {
    entity.kind = EntityKind::kSwitch;
    make_levels(entity);
    entity.write = Call{io, "write", {pin, std::nullopt}, "level", true};
}

/// False: a pin in this mode shows nothing.
bool make_of_mode(Entity& entity, const model::Description& description, const std::string& io,
                  std::size_t pin, PinMode mode) {
    const auto number = static_cast<double>(pin);
    switch (mode) {
        case PinMode::kInput:
        case PinMode::kInputPullup:
            entity.kind = EntityKind::kBinarySensor;
            make_levels(entity);
            entity.read = ValuePlace{io, "/digital/" + std::to_string(pin)};
            return true;
        case PinMode::kOutput:
            make_switch(entity, io, number);
            return true;
        case PinMode::kPwm: {
            const auto kind = description.labels.labels.find("kind");
            const bool light = kind != description.labels.labels.end() && kind->second == "light";
            entity.kind = light ? EntityKind::kLight : EntityKind::kNumber;
            entity.whole = true;
            entity.min = 0;
            entity.max = kMaxDuty;
            entity.write = Call{io, "pwm", {number, std::nullopt}, "duty", true};
            return true;
        }
        case PinMode::kAnalog: {
            const auto channel = channel_of(description.pins, pin);
            if (!channel) return false;
            entity.kind = EntityKind::kSensor;
            entity.whole = true;
            entity.min = 0;
            entity.max = kMaxAnalog;
            entity.read = ValuePlace{io, "/analog/" + std::to_string(*channel)};
            return true;
        }
        default:
            return false;
    }
}

}  // namespace

std::vector<Entity> pin_entities(const model::Description& description, const model::ServiceInfo& io) {
    std::vector<Entity> result;
    const auto& pins = description.pins;
    const auto count = std::max({pins.modes.size(), pins.owners.size(), pins.capabilities.size()});
    for (std::size_t pin = 0; pin < count; ++pin) {
        const char owner = at(pins.owners, pin, '-');
        if (owner != '-' && owner != io.id) continue;
        Entity entity;
        entity.id = "pin-" + std::to_string(pin);
        entity.name = description.labels.pin(static_cast<int>(pin));
        entity.default_on = !entity.name.empty();
        const auto mode = mode_of(pins, pin);
        if (mode == PinMode::kUnallocated && !entity.name.empty() &&
            ((at(pins.capabilities, pin, '1') - '0') & protocol::kCapabilityDigital) != 0) {
            // It has a name, so it is used, and nothing says for what: hidden until a user wants it.
            make_switch(entity, io.name, static_cast<double>(pin));
            entity.before = Call{io.name, "mode", {static_cast<double>(pin), kOutput}, "mode", true};
            entity.default_on = false;
        } else if (!make_of_mode(entity, description, io.name, pin, mode)) {
            continue;
        }
        if (entity.name.empty()) entity.name = "Pin " + std::to_string(pin);
        result.push_back(std::move(entity));
    }
    return result;
}

}  // namespace asip::gateway::exports
