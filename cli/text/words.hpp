// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace asip::cli {

/// `1 topic`, `2 topics`
inline std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// How often something happened, as another program says: without its fraction, from 0 to 1e18.
inline std::string count_text(double count) {
    return std::to_string(static_cast<std::uint64_t>(std::clamp(count, 0.0, 1e18)));
}

/// `a, b, c`. `text_of` makes a word of an item.
template <class Items, class TextOf = std::identity>
std::string listed(const Items& items, const char* between = ", ", TextOf text_of = {}) {
    std::string text;
    for (const auto& item : items)
        text += (text.empty() ? "" : between) + std::string(std::invoke(text_of, item));
    return text;
}

}  // namespace asip::cli
