// SPDX-License-Identifier: Apache-2.0
// Pins and what is done with them, in words. Pure.
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/protocol/body.hpp"
#include "asip/text/nearest.hpp"
#include "cli/commands/pin.hpp"

namespace asip::cli {

using protocol::PinMode;

Outcome<std::vector<PinMode>> modes_of(const std::string& answer) {
    const auto document = model::parse_json(answer);
    if (!document || !document->is_object() || !document->contains("modes") ||
        !(*document)["modes"].is_array()) {
        return failure(program::kExitFailure, "the board did not report its pin modes");
    }
    std::vector<PinMode> result;
    for (const auto& number : (*document)["modes"]) {
        const auto mode =
            number.is_number_integer() ? protocol::pin_mode_from_number(number.get<int>()) : std::nullopt;
        result.push_back(mode.value_or(PinMode::kInvalid));
    }
    return result;
}

std::string value_text(const PinReading& reading) {
    if (!reading.value) return {};
    if (reading.mode == PinMode::kAnalog || reading.mode == PinMode::kPwm)
        return std::to_string(*reading.value);
    return *reading.value == 0 ? "low" : "high";
}

Outcome<int> parse_pin(std::string_view text, const model::PinsInfo& pins) {
    const bool analog = text.size() > 1 && (text[0] == 'A' || text[0] == 'a');
    const bool digital = text.size() > 1 && (text[0] == 'D' || text[0] == 'd');
    const auto number = protocol::parse_integer(analog || digital ? text.substr(1) : text);
    if (!number || *number < 0 || *number > 255)
        return failure(program::kExitUsage, "'" + std::string(text) + "' is not a pin; write 13, D13 or A0");
    if (!analog) return static_cast<int>(*number);
    for (const auto& [pin, channel] : pins.analog)
        if (channel == *number) return pin;
    return failure(program::kExitUsage, "the board has no analog channel " + std::to_string(*number));
}

Outcome<int> find_pin(std::string_view text, const model::Description& description) {
    auto number = parse_pin(text, description.pins);
    if (number) return number;
    std::optional<int> found;
    for (const auto& [pin, name] : description.labels.pins) {
        if (name != text) continue;
        if (found)
            return failure(program::kExitUsage, "pins " + std::to_string(*found) + " and " +
                                                    std::to_string(pin) + " are both called " + name +
                                                    "; write the number");
        found = pin;
    }
    return found ? Outcome<int>(*found) : number;
}

std::string why_taken(const model::Description& description, int pin) {
    const auto index = static_cast<std::size_t>(pin);
    const char owner = index < description.pins.owners.size() ? description.pins.owners[index] : '\0';
    const auto where = "; pin " + std::to_string(pin);
    if (owner == '@') return where + " belongs to the board itself, such as its serial line";
    for (const auto& service : description.services) {
        if (service.id != owner || owner == '\0' || service.name == "io") continue;
        const auto name = description.board + "/" + service.name;
        return where + " belongs to the service " + name + ": command that, see asipctl show " + name;
    }
    return {};
}

Outcome<PinAction> parse_pin_word(std::string_view word) {
    if (word == "high" || word == "on") return PinAction{PinAction::Kind::kWrite, PinMode::kOutput, 1};
    if (word == "low" || word == "off") return PinAction{PinAction::Kind::kWrite, PinMode::kOutput, 0};
    if (word == "toggle") return PinAction{PinAction::Kind::kToggle, PinMode::kOutput, 0};
    if (const auto number = protocol::parse_integer(word)) {
        if (*number >= 0 && *number <= 255)
            return PinAction{PinAction::Kind::kPwm, PinMode::kPwm, static_cast<int>(*number)};
        return failure(program::kExitUsage, "PWM goes from 0 to 255, not " + std::string(word));
    }
    const auto mode = protocol::pin_mode_from_text(word);
    if (mode && protocol::is_settable(*mode)) return PinAction{PinAction::Kind::kMode, *mode, 0};
    const std::vector<std::string> words{"high",  "low",    "on",     "off",    "toggle",
                                         "input", "pullup", "output", "analog", "pwm"};
    return failure(program::kExitUsage,
                   "'" + std::string(word) + "'" + text::did_you_mean(word, words) +
                       ": write high, low, toggle, input, pullup, output, analog, pwm or 0..255");
}

std::vector<std::string> pin_requests(int pin, const PinAction& action, std::optional<PinMode> mode) {
    const auto number = std::to_string(pin);
    const auto set_mode = "P," + number + "," + std::to_string(static_cast<int>(action.mode));
    std::vector<std::string> result;
    if (action.kind == PinAction::Kind::kMode || mode != action.mode) result.push_back(set_mode);
    if (action.kind == PinAction::Kind::kWrite)
        result.push_back("d," + number + "," + std::to_string(action.value));
    if (action.kind == PinAction::Kind::kPwm)
        result.push_back("a," + number + "," + std::to_string(action.value));
    return result;
}

}  // namespace asip::cli
