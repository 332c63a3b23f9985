// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "asip/protocol/checksum.hpp"

namespace truth {

inline std::string_view without_checksum(std::string_view line) {
    if (const auto checked = asip::protocol::verify_checksum(line)) return *checked;
    return line;
}

/// `D,A,100`: it sets how often the board reports.
inline bool is_period(std::string_view line) {
    return line.size() > 3 && line[0] != '#' && line[2] == 'A';
}

inline std::string_view without_return(std::string_view line) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

}  // namespace truth
