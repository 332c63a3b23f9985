#pragma once
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace asip::session {

/// One service as the board names it in `#,N`.
struct BoardService {
    char letter = '?';
    std::string title;  ///< as the board says it, at most 64 characters; empty if it gives none

    friend bool operator==(const BoardService&, const BoardService&) = default;
};

/// What a board told about itself. Whatever it did not answer is empty; nothing here is guessed.
struct Identity {
    int version_major = 0;
    int version_minor = 0;
    std::string chip;
    std::string sketch;
    std::string stored_name;  ///< from the identity extension; empty if it has none
    unsigned pin_count = 0;
    std::vector<BoardService> services;  ///< in the board's order, one entry a letter
    std::map<char, int> extensions;      ///< tag to version; empty on a 0.4 board

    /// One character a pin, or empty: service letter, '@' for the system, '-' for none.
    std::string pin_owners;
    /// One digit a pin, or empty: bit 0 digital, bit 1 analog in, bit 2 PWM.
    std::string pin_capabilities;
    /// One digit a pin, or empty: protocol::PinMode at the time of asking.
    std::string pin_modes;
    /// Digital pin and its analog channel.
    std::vector<std::pair<unsigned, unsigned>> analog_pins;
    /// Port and bit mask of each pin, in pin order: what digital events are decoded with.
    std::vector<std::pair<unsigned, unsigned>> port_map;

    bool has_extension(char tag) const { return extensions.contains(tag); }
    const BoardService* find_service(char letter) const;
    /// "0.4"
    std::string version() const;

    friend bool operator==(const Identity&, const Identity&) = default;
};

}  // namespace asip::session
