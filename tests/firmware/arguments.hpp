// SPDX-License-Identifier: Apache-2.0
// What stands behind the tag of a request, as docs/protocol.md reads it.
#pragma once
#include <cstdint>
#include <string_view>

namespace wire {

struct Arguments {
    /// kEither: the page leaves it to the board whether it refuses them, but not what they are.
    enum Are : std::uint8_t { kGood, kWrong, kEither } are = kWrong;
    std::int32_t first = 0;
    std::int32_t second = -1;  ///< -1: there is none
    std::string_view text{};
};

struct Number {
    Arguments::Are is;
    std::int32_t value;
    static Number of(std::string_view text, bool is_signed);
};

/// `,SIGNED[,NUMBER]`
Arguments arguments_of_numbers(std::string_view rest);
/// `,NUMBER,NUMBER`
Arguments arguments_of_pin(std::string_view rest);
/// `,NUMBER,TEXT`. The page does not say whether there may be no text.
Arguments arguments_of_text(std::string_view rest);
/// `,TOKEN`: 1 to 8 letters or digits.
bool is_token(std::string_view rest);

}  // namespace wire
