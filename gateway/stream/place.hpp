// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <charconv>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace asip::gateway {

/// Where an event stands in its stream: `EPOCH-N`. Numbers step by one; another epoch (another run of the
/// gateway) is another count, and says nothing of this one.
struct Place {
    std::string epoch;
    std::uint64_t number = 0;

    std::string text() const { return epoch + "-" + std::to_string(number); }
    friend bool operator==(const Place&, const Place&) = default;
};

/// Reads what text() wrote. Nothing for any other text, of more than 64 bytes, or with a number beyond 64
/// bits.
inline std::optional<Place> parse_place(std::string_view text) {
    const auto dash = text.rfind('-');
    if (dash == std::string_view::npos || dash == 0 || text.size() > 64) return std::nullopt;
    Place place;
    place.epoch = text.substr(0, dash);
    const auto* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + dash + 1, end, place.number);
    if (error != std::errc() || rest != end) return std::nullopt;
    return place;
}

/// Where a reader stood in each of many services. Each counts for itself.
struct Places {
    std::string epoch;
    std::map<std::string, std::uint64_t, std::less<>> services;  ///< "BOARD/SERVICE" -> number
    std::optional<std::uint64_t> others;  ///< of those not named: the reader had all that there was
};

}  // namespace asip::gateway
