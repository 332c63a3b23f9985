// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/protocol/board_info.hpp"
#include "asip/protocol/extensions.hpp"
#include "asip/protocol/pin.hpp"
#include "asip/protocol/port_map.hpp"

namespace asip::session {

/// What a board answered about itself. Whatever it did not answer is empty; nothing here is guessed.
struct Identity {
    protocol::BoardInfo info;
    std::string stored_name;                      ///< from the identity extension; empty if it has none
    std::vector<protocol::ServiceName> services;  ///< in the board's order, one entry a letter
    protocol::Extensions extensions;              ///< empty on a 0.4 board
    std::string pin_owners;                       ///< one character a pin, or empty
    std::vector<std::uint8_t> pin_capabilities;   ///< bits of pin.hpp, or empty
    std::vector<protocol::PinMode> pin_modes;     ///< kept up to date while requests change them; or empty
    protocol::AnalogMap analog_pins;
    protocol::PortMap port_map;

    /// The service with this letter, or null. Valid as long as `services` is not changed.
    const protocol::ServiceName* find_service(char letter) const;
};

/// Whether both are the same board with the same services, whatever the modes of their pins and
/// the line rate are.
bool same_board(const Identity& a, const Identity& b);
/// Whether they are two boards for sure, or one with another sketch.
bool is_other_board(const Identity& a, const Identity& b);

}  // namespace asip::session
