#pragma once
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"

namespace asip::protocol {

inline constexpr char kEcho = 'E';
inline constexpr char kIdentity = 'I';
inline constexpr char kLineRate = 'B';
inline constexpr char kChecksum = 'C';

/// What a board answered to `#,X`: tags and versions, in the board's order. Empty for a 0.4 board.
struct Extensions {
    std::vector<std::pair<char, int>> list;

    /// 0 when the board does not have it.
    int version(char tag) const;
    bool has(char tag) const { return version(tag) > 0; }
    bool empty() const { return list.empty(); }
    friend bool operator==(const Extensions&, const Extensions&) = default;
};

/// From the body of `@#,X`: `4,{E:1,I:1,B:1,C:1}`.
Expected<Extensions> parse_extensions(std::string_view body);

}  // namespace asip::protocol
