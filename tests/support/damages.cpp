// SPDX-License-Identifier: Apache-2.0
#include "tests/support/damages.hpp"

#include <fmt/format.h>

namespace wire {

std::string visible(std::string_view bytes) {
    std::string text;
    for (const char c : bytes)
        text +=
            c > ' ' && c < 0x7F ? std::string(1, c) : fmt::format("\\x{:02X}", static_cast<unsigned char>(c));
    return text;
}

bool each_damage(std::string_view line, std::string_view bytes,
                 const std::function<bool(const std::string&)>& tried) {
    for (std::size_t at = 0; at <= line.size(); ++at) {
        const std::string before(line.substr(0, at));
        const std::string rest(line.substr(at));
        for (const char byte : bytes) {
            if (!tried(before + byte + rest)) return false;
            if (!rest.empty() && byte != rest.front() && !tried(before + byte + rest.substr(1))) return false;
        }
        if (rest.empty()) continue;
        if (!tried(before + rest.substr(1)) || !tried(before + rest.front() + rest)) return false;
    }
    return true;
}

}  // namespace wire
