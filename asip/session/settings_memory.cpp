// SPDX-License-Identifier: Apache-2.0
#include "asip/session/settings_memory.hpp"

#include "asip/protocol/body.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/protocol/request.hpp"

namespace asip::session {

std::optional<ModeRequest> parse_mode_request(std::string_view line) {
    const auto request = protocol::parse_request(line);
    if (!request || request->service != 'I' || request->tag != 'P') return std::nullopt;
    const auto parts = protocol::split_fields(request->parameters, ',');
    if (parts.size() != 2) return std::nullopt;
    const auto pin = protocol::parse_integer(parts[0]);
    const auto mode = protocol::parse_integer(parts[1]);
    if (!pin || !mode || *pin < 0 || *pin >= static_cast<std::int64_t>(protocol::kMaxPins) || *mode < 0 ||
        *mode > 8)
        return std::nullopt;
    return ModeRequest{static_cast<int>(*pin), static_cast<int>(*mode)};
}

void SettingsMemory::executed(std::string_view line) {
    const auto request = protocol::parse_request(line);
    if (!request) return;
    if (request->service == '#' && request->tag == 'R') {
        modes_.clear();
        periods_.clear();
    } else if (const auto mode = parse_mode_request(line)) {
        modes_[mode->pin] = std::string(line);
    } else if (request->tag == 'A' && request->service != '#') {
        const auto period = protocol::parse_integer(request->parameters);
        if (period && *period >= 0 && *period <= 65535)
            periods_[request->service] = static_cast<unsigned>(*period);
    }
}

void SettingsMemory::refused(std::string_view line) {
    const auto request = protocol::parse_request(line);
    if (!request) return;
    if (const auto mode = parse_mode_request(line)) {
        const auto known = modes_.find(mode->pin);
        if (known != modes_.end() && known->second == line) modes_.erase(known);
    } else if (request->tag == 'A') {
        const auto known = periods_.find(request->service);
        if (known != periods_.end() && std::to_string(known->second) == request->parameters)
            periods_.erase(known);
    }
}

bool SettingsMemory::is_setting(std::string_view line) {
    const auto request = protocol::parse_request(line);
    return request && (parse_mode_request(line) || (request->tag == 'A' && request->service != '#'));
}

std::vector<std::string> SettingsMemory::restore() const {
    std::vector<std::string> lines;
    for (const auto& [pin, line] : modes_)
        lines.push_back(line);
    for (const auto& [service, period] : periods_)
        lines.push_back(std::string{service, ','} + "A," + std::to_string(period));
    return lines;
}

std::optional<unsigned> SettingsMemory::period(char service) const {
    const auto known = periods_.find(service);
    if (known == periods_.end()) return std::nullopt;
    return known->second;
}

}  // namespace asip::session
