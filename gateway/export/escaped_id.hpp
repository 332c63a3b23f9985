// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::gateway::exports {

/// `text` with `mark` and two hexadecimal digits in place of each character that is not `plain`. Two texts
/// never become one, as long as no text that stays as it is holds `mark`.
template <class Plain>
std::string escaped_id(std::string_view text, std::string_view mark, Plain plain) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string id;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (plain(c))
            id += c;
        else
            (id += mark) += {kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
    return id;
}

}  // namespace asip::gateway::exports
