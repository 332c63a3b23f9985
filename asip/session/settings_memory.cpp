// SPDX-License-Identifier: Apache-2.0
#include "asip/session/settings_memory.hpp"

#include "asip/protocol/body.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

using protocol::PinMode;

struct PinRequest {
    char tag;
    int pin;
    int value;
};

/// `I,P`, `I,d` or `I,a`, with its two numbers.
std::optional<PinRequest> read_pin(const protocol::Request& request) {
    if (request.service != 'I' || (request.tag != 'P' && request.tag != 'd' && request.tag != 'a'))
        return std::nullopt;
    const auto parts = protocol::split_fields(request.parameters, ',');
    if (parts.size() != 2) return std::nullopt;
    const auto pin = protocol::parse_integer(parts[0]);
    const auto value = protocol::parse_integer(parts[1]);
    if (!pin || !value || *pin < 0 || *pin >= static_cast<std::int64_t>(protocol::kMaxPins) || *value < 0 ||
        *value > 255)
        return std::nullopt;
    return PinRequest{request.tag, static_cast<int>(*pin), static_cast<int>(*value)};
}

std::optional<PinRequest> parse_pin(std::string_view line) {
    const auto request = protocol::parse_request(line);
    return request ? read_pin(*request) : std::nullopt;
}

std::optional<PinRequest> parse_write(std::string_view line) {
    const auto request = parse_pin(line);
    return request && request->tag == 'd' ? request : std::nullopt;
}

bool drives(int mode) {
    return mode == static_cast<int>(PinMode::kOutput) || mode == static_cast<int>(PinMode::kPwm);
}

/// What makes a pin that drives nothing yet ready to begin at `level`; empty: nothing does, or need.
std::string prepare(int pin, bool level, PinMode present) {
    if (protocol::is_digital_input(present) || present == PinMode::kOutput)
        return protocol::digital_write(pin, level);
    return level ? protocol::set_pin_mode(pin, PinMode::kInputPullup) : std::string();
}

}  // namespace

std::optional<ModeRequest> parse_mode_request(std::string_view line) {
    const auto request = parse_pin(line);
    if (!request || request->tag != 'P' || request->value > 8) return std::nullopt;
    return ModeRequest{request->pin, request->value};
}

void SettingsMemory::executed(std::string_view line, bool keeps_level) {
    const auto request = protocol::parse_request(line);
    if (!request) return;
    if (request->service == '#' && request->tag == 'R') {
        *this = {};
    } else if (const auto pin = read_pin(*request)) {
        if (pin->tag == 'd') levels_[pin->pin] = pin->value != 0;
        if (pin->tag == 'P' && pin->value <= 8) mode_executed({pin->pin, pin->value}, line, keeps_level);
        if (pin->tag == 'a' && modes_.contains(pin->pin))
            mode_executed({pin->pin, static_cast<int>(PinMode::kPwm)},
                          protocol::set_pin_mode(pin->pin, PinMode::kPwm), keeps_level);
    } else if (request->tag == 'A' && request->service != '#') {
        const auto period = protocol::parse_integer(request->parameters);
        if (period && *period >= 0 && *period <= 65535)
            periods_[request->service] = static_cast<unsigned>(*period);
    }
}

void SettingsMemory::mode_executed(const ModeRequest& mode, std::string_view line, bool keeps_level) {
    if (!keeps_level || mode.mode != static_cast<int>(PinMode::kOutput)) levels_.erase(mode.pin);
    modes_[mode.pin] = std::string(line);
}

void SettingsMemory::in_doubt(std::string_view line) {
    if (const auto pin = parse_pin(line)) levels_.erase(pin->pin);
}

void SettingsMemory::refused(std::string_view line) {
    const auto request = protocol::parse_request(line);
    if (!request) return;
    if (const auto mode = parse_mode_request(line)) {
        const auto known = modes_.find(mode->pin);
        if (known != modes_.end() && known->second == line) modes_.erase(known);
    } else if (const auto write = parse_write(line)) {
        const auto known = levels_.find(write->pin);
        if (known != levels_.end() && known->second == (write->value != 0)) levels_.erase(known);
    } else if (request->tag == 'A') {
        const auto known = periods_.find(request->service);
        if (known != periods_.end() && std::to_string(known->second) == request->parameters)
            periods_.erase(known);
    }
}

bool SettingsMemory::is_setting(std::string_view line) {
    const auto request = protocol::parse_request(line);
    return request && (parse_mode_request(line) || parse_write(line) ||
                       (request->tag == 'A' && request->service != '#'));
}

std::vector<SettingsMemory::Setting> SettingsMemory::restore(const std::vector<PinMode>& present,
                                                             bool outputs) const {
    std::vector<Setting> settings;
    for (const auto& [pin, line] : modes_) {
        if (!outputs && drives(parse_mode_request(line)->mode)) continue;
        const auto level = is_output(pin) ? levels_.find(pin) : levels_.end();
        if (level == levels_.end()) {
            settings.push_back({line});
            continue;
        }
        const auto at = static_cast<std::size_t>(pin);
        const auto first = at < present.size() ? prepare(pin, level->second, present[at]) : std::string();
        const auto write = protocol::digital_write(pin, level->second);
        if (!first.empty()) settings.push_back({first});
        settings.push_back({line, write});
        settings.push_back({write});
    }
    for (const auto& [service, period] : periods_)
        settings.push_back({std::string{service, ','} + "A," + std::to_string(period)});
    return settings;
}

bool SettingsMemory::is_output(int pin) const {
    const auto mode = modes_.find(pin);
    return mode != modes_.end() &&
           parse_mode_request(mode->second)->mode == static_cast<int>(PinMode::kOutput);
}

std::vector<std::string> SettingsMemory::levels() const {
    std::vector<std::string> lines;
    for (const auto& [pin, level] : levels_)
        if (is_output(pin)) lines.push_back(protocol::digital_write(pin, level));
    return lines;
}

std::optional<unsigned> SettingsMemory::period(char service) const {
    const auto known = periods_.find(service);
    if (known == periods_.end()) return std::nullopt;
    return known->second;
}

}  // namespace asip::session
