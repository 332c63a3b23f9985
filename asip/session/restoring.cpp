// SPDX-License-Identifier: Apache-2.0
// What clients had set is set again once the board is back.
#include <utility>

#include "asip/protocol/request.hpp"
#include "asip/session/machine.hpp"

namespace asip::session {

void Machine::restore_settings() {
    const bool drives = outputs_ == Outputs::kFree;
    if (!drives) outputs_ = Outputs::kOwed;
    const auto present = keeps_level() ? identity_.pin_modes : std::vector<protocol::PinMode>();
    for (auto& [line, next] : settings_.restore(present, drives)) {
        Request request;
        request.line = std::move(line);
        request.restores = true;
        if (!next.empty()) request.bytes_behind = next.size() + 1 + Wire::kChecksumBytes;
        queue_.waiting().push_own(std::move(request));
    }
}

// ASIP 0.4 ends the level of a pin by its mode.
bool Machine::keeps_level() const {
    return !identity_.extensions.empty();
}

void Machine::hold_outputs(bool hold) {
    if (!hold && outputs_ == Outputs::kOwed) restore_again_ = true;
    if (!hold) outputs_ = Outputs::kFree;
    if (!hold || outputs_ != Outputs::kFree) return;
    outputs_ = Outputs::kHeld;
    // Outputs may be among those that were not sent yet.
    if (queue_.waiting().forget_own([](const Request& own) { return own.restores; }) > 0) restore_settings();
}

void Machine::will_execute(std::string_view line) {
    const auto write = protocol::parse_request(line);
    if (!write || write->service != 'I' || write->tag != 'd') return;
    settings_.executed(line, keeps_level());
    const auto pin = line.substr(0, line.rfind(',') + 1);
    queue_.waiting().forget_own([&](const Request& own) { return own.line.starts_with(pin); });
}

}  // namespace asip::session
