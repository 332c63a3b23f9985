// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace asip::cli {

/// `1 topic`, `2 topics`
inline std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// How often something happened, as another program says: without its fraction, from 0 to 1e18.
inline std::string count_text(double count) {
    return std::to_string(static_cast<std::uint64_t>(std::clamp(count, 0.0, 1e18)));
}

/// `a, b, c`
inline std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words)
        text += (text.empty() ? "" : ", ") + word;
    return text;
}

}  // namespace asip::cli
