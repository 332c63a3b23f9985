// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/extensions.hpp"

#include <algorithm>

#include "asip/protocol/body.hpp"
#include "asip/protocol/limits.hpp"

namespace asip::protocol {

int Extensions::version(char tag) const {
    for (const auto& [letter, number] : list)
        if (letter == tag) return number;
    return 0;
}

std::size_t Extensions::longest_request() const {
    return std::clamp(static_cast<std::size_t>(version(kRequestLength)), kUsualRequestBytes,
                      kMaxRequestBytes);
}

std::string version_text(int version) {
    return std::to_string(version / 100) + "." + std::to_string(version % 100);
}

Expected<Extensions> parse_extensions(std::string_view body) {
    const auto parsed = parse_body(body);
    if (!parsed) return fail(parsed.error());
    Extensions result;
    for (const auto item : parsed->items) {
        const auto fields = split_fields(item);
        if (fields.size() != 2 || fields[0].size() != 1) return fail("extension is not TAG:VERSION");
        const auto version = parse_integer(fields[1]);
        if (!version || *version < 0 || *version > 255)
            return fail("extension version is not a number from 0 to 255");
        result.list.emplace_back(fields[0].front(), static_cast<int>(*version));
    }
    return result;
}

}  // namespace asip::protocol
