// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::sim {

/// Where an Arduino pin sits.
struct ChipPin {
    char port;    ///< 'A'..'L'; '-' for A6 and A7 of a Nano, which have a converter only
    int bit;      ///< 0..7
    int channel;  ///< ADC channel, or -1
};

/// Its chip, and the port bits of its pins.
struct BoardKind {
    std::string name;           ///< "uno", "nano", "mega", "leonardo", "1284p"
    std::string chip;           ///< simavr's name: "atmega328p", "atmega2560", "atmega32u4"
    std::vector<ChipPin> pins;  ///< index = Arduino pin number
    std::vector<int> analog;    ///< Arduino pin number of A0, A1, ...
    int sda, scl;               ///< Arduino pins of the I2C bus
    char uart;                  ///< the USART that is looked at as the serial port: '0', or '1' on a Leonardo

    /// As listed to a person.
    static const std::vector<BoardKind>& all();
    static const BoardKind* find(std::string_view name);

    /// "13", "A0"; the error names the pins.
    Expected<int> parse_pin(std::string_view text) const;
};

}  // namespace asip::sim
