// SPDX-License-Identifier: Apache-2.0
// What a pin is comes from its meaning, else from the last mode that a command set. A mode that a sketch has
// by itself after a start decides nothing.
#include <algorithm>

#include "asip/property/service_properties.hpp"
#include "asip/protocol/pin.hpp"

namespace asip::property {
namespace {

using protocol::PinMode;

constexpr double kMaxDuty = 255;
constexpr double kMaxAnalog = 1023;
constexpr std::size_t kPinAt = 0, kValueAt = 1;  // arguments of `write`, `pwm`, `mode`

char at(const std::string& text, std::size_t pin, char otherwise) {
    return pin < text.size() ? text[pin] : otherwise;
}

std::optional<int> channel_of(const model::PinsInfo& pins, std::size_t pin) {
    for (const auto& [digital, channel] : pins.analog)
        if (digital == pin) return channel;
    return std::nullopt;
}

bool is_input(PinMode mode) {
    return protocol::is_digital_input(mode) || mode == PinMode::kAnalog;
}

/// The mode in which a pin is used; nothing: for nothing.
std::optional<PinMode> use_of(std::optional<model::ClassUse> use, std::optional<PinMode> commanded) {
    if (!use) return commanded;
    if (*use == model::ClassUse::kNumber) return commanded.value_or(PinMode::kAnalog);
    if (*use == model::ClassUse::kInput)
        return commanded && is_input(*commanded) ? *commanded : PinMode::kInputPullup;
    return commanded == PinMode::kPwm ? PinMode::kPwm : PinMode::kOutput;
}

class PinProperty {
  public:
    PinProperty(const model::Description& description, const model::ServiceInfo& io, std::size_t pin)
        : description_(description), io_(io), pin_(pin) {}

    std::optional<Property> make() {
        property_.id = io_.name + "/" + std::to_string(pin_);
        property_.service = io_.name;
        const auto& labels = description_.labels;
        const auto meaning = labels.meanings.find(property_.id);
        const auto klass = meaning == labels.meanings.end() ? std::string() : meaning->second.klass;
        const auto mode = labels.modes.find(static_cast<int>(pin_));
        const auto commanded = mode == labels.modes.end() || mode->second == 0
                                   ? std::nullopt
                                   : protocol::pin_mode_from_number(mode->second);
        const auto use = use_of(model::use_of_class(klass), commanded);
        if (!use || !make_of(*use, klass == "light")) return std::nullopt;
        const auto present = protocol::pin_mode_from_number(at(description_.pins.modes, pin_, '0') - '0');
        property_.floating =
            property_.read && !is_input(commanded.value_or(present.value_or(PinMode::kInvalid)));
        if (property_.write && present != *use)
            property_.before = Call{io_.name, "mode", {number(), static_cast<double>(*use)}};
        if (property_.write && commanded && *commanded != *use)
            property_.refused = "a command made pin " + std::to_string(pin_) + " " +
                                std::string(protocol::to_text(*commanded)) + ", and " + klass +
                                " needs an output: asipctl pin " + description_.board + " " +
                                std::to_string(pin_) + " output";
        property_.name = labels.pin(static_cast<int>(pin_));
        property_.advanced = property_.name.empty() && klass.empty();
        if (property_.name.empty()) property_.name = usual_name();
        return std::move(property_);
    }

  private:
    double number() const { return static_cast<double>(pin_); }

    std::string usual_name() const {
        const auto channel = channel_of(description_.pins, pin_);
        return "Pin " + (channel ? "A" + std::to_string(*channel) : std::to_string(pin_));
    }

    void make_levels() {
        property_.whole = true;
        property_.choices = {{"off", 0}, {"on", 1}};
    }

    bool make_of(PinMode use, bool light) {
        switch (use) {
            case PinMode::kInput:
            case PinMode::kInputPullup:
                property_.kind = Kind::kBinarySensor;
                make_levels();
                invert(use == PinMode::kInputPullup);
                property_.read = Place{io_.name, "/digital/" + std::to_string(pin_)};
                return true;
            case PinMode::kOutput:
                property_.kind = light ? Kind::kLight : Kind::kSwitch;
                make_levels();
                if (light) property_.max = 1;
                invert(false);
                add_write("write");
                return true;
            case PinMode::kPwm:
                property_.kind = light ? Kind::kLight : Kind::kNumber;
                make_range(kMaxDuty);
                add_write("pwm");
                return true;
            case PinMode::kAnalog: {
                const auto channel = channel_of(description_.pins, pin_);
                if (!channel) return false;
                make_range(kMaxAnalog);
                property_.read = Place{io_.name, "/analog/" + std::to_string(*channel)};
                return true;
            }
            default:
                return false;
        }
    }

    void make_range(double max) {
        property_.whole = true;
        property_.min = 0;
        property_.max = max;
    }

    /// An input with a pull-up is low while its button is pressed, so low means on there unless people say
    /// otherwise.
    void invert(bool usually) {
        const auto meaning = description_.labels.meanings.find(property_.id);
        const bool said = meaning != description_.labels.meanings.end() && meaning->second.inverted;
        if (said ? *meaning->second.inverted : usually)
            std::swap(property_.choices[0].second, property_.choices[1].second);
    }

    /// The last of `write` and `pwm` counts, and `mode` ends both.
    void add_write(const char* command) {
        property_.write = Call{io_.name, command, {number(), std::nullopt}};
        const auto pin = static_cast<int>(pin_);
        const std::string other = std::string(command) == "write" ? "pwm" : "write";
        property_.setters = {{command, kPinAt, pin, kValueAt},
                             {other, kPinAt, pin, std::nullopt},
                             {"mode", kPinAt, pin, std::nullopt}};
    }

    const model::Description& description_;
    const model::ServiceInfo& io_;
    const std::size_t pin_;
    Property property_;
};

}  // namespace

std::vector<Property> pin_properties(const model::Description& description, const model::ServiceInfo& io) {
    std::vector<Property> result;
    const auto& pins = description.pins;
    auto count = std::max({pins.modes.size(), pins.owners.size(), pins.capabilities.size()});
    // A board that says nothing of its pins has those that commands set.
    if (count == 0 && !description.labels.modes.empty())
        count = static_cast<std::size_t>(description.labels.modes.rbegin()->first) + 1;
    for (std::size_t pin = 0; pin < count; ++pin) {
        const char owner = at(pins.owners, pin, '-');
        if (owner != '-' && owner != io.id) continue;
        if (auto property = PinProperty(description, io, pin).make()) result.push_back(std::move(*property));
    }
    return result;
}

}  // namespace asip::property
