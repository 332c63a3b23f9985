// SPDX-License-Identifier: Apache-2.0
#include "sim/board_kind.hpp"

#include <fmt/format.h>

#include <charconv>

namespace asip::sim {
namespace {

// Each text lists the pins in Arduino order: port, bit, and a hexadecimal ADC channel or '-'. The numbering
// is that of the boards' silk screens and of the Arduino core's variants.
BoardKind make(std::string name, std::string chip, char uart, std::string_view pins, std::vector<int> analog,
               int sda, int scl) {
    BoardKind kind{std::move(name), std::move(chip), {}, std::move(analog), sda, scl, uart};
    for (std::size_t i = 0; i + 2 < pins.size(); i += 4) {
        const char channel = pins[i + 2];
        kind.pins.push_back({pins[i], pins[i + 1] - '0',
                             channel == '-'                     ? -1
                             : channel >= 'a' && channel <= 'f' ? channel - 'a' + 10
                                                                : channel - '0'});
    }
    return kind;
}

std::vector<int> count_up(int first, int count) {
    std::vector<int> pins;
    for (int i = 0; i < count; ++i)
        pins.push_back(first + i);
    return pins;
}

}  // namespace

const std::vector<BoardKind>& BoardKind::all() {
    static const std::vector<BoardKind> kinds = {
        make("uno", "atmega328p", '0',
             "D0- D1- D2- D3- D4- D5- D6- D7- B0- B1- B2- B3- B4- B5- C00 C11 C22 C33 C44 C55",
             count_up(14, 6), 18, 19),
        make(
            "mega", "atmega2560", '0',
            "E0- E1- E4- E5- G5- E3- H3- H4- H5- H6- B4- B5- B6- B7- J1- J0- H1- H0- D3- D2- D1- D0- A0- A1- "
            "A2- A3- A4- A5- A6- A7- C7- C6- C5- C4- C3- C2- C1- C0- D7- G2- G1- G0- L7- L6- L5- L4- L3- L2- "
            "L1- L0- B3- B2- B1- B0- F00 F11 F22 F33 F44 F55 F66 F77 K08 K19 K2a K3b K4c K5d K6e K7f",
            count_up(54, 16), 20, 21),
        make(
            "leonardo", "atmega32u4", '1',
            "D2- D3- D1- D0- D48 C6- D7a E6- B4b B5c B6d B7- D69 C7- B3- B1- B2- B0- F77 F66 F55 F44 F11 F00",
            {18, 19, 20, 21, 22, 23, 4, 6, 8, 9, 10, 12}, 2, 3),
        make("nano", "atmega328p", '0',
             "D0- D1- D2- D3- D4- D5- D6- D7- B0- B1- B2- B3- B4- B5- C00 C11 C22 C33 C44 C55 -06 -07",
             count_up(14, 8), 18, 19),
        make("1284p", "atmega1284p", '0',
             "B0- B1- B2- B3- B4- B5- B6- B7- D0- D1- D2- D3- D4- D5- D6- D7- C0- C1- C2- C3- C4- C5- C6- "
             "C7- A00 A11 A22 A33 A44 A55 A66 A77",
             count_up(24, 8), 17, 16),
    };
    return kinds;
}

const BoardKind* BoardKind::find(std::string_view name) {
    for (const auto& kind : all())
        if (kind.name == name) return &kind;
    return nullptr;
}

Expected<int> BoardKind::parse_pin(std::string_view text) const {
    const bool is_analog = !text.empty() && (text.front() == 'A' || text.front() == 'a');
    const auto digits = is_analog ? text.substr(1) : text;
    int number = -1;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    const bool is_number = error == std::errc() && end == digits.data() + digits.size() && number >= 0;
    if (is_number && is_analog && number < static_cast<int>(analog.size()))
        return analog[static_cast<std::size_t>(number)];
    if (is_number && !is_analog && number < static_cast<int>(pins.size())) return number;
    return fail(fmt::format("there is no pin {} on the {} (0 to {}, A0 to A{})", text, name, pins.size() - 1,
                            analog.size() - 1));
}

}  // namespace asip::sim
