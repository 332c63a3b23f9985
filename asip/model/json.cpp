// SPDX-License-Identifier: Apache-2.0
#include "asip/model/json.hpp"

#include <nlohmann/json.hpp>

namespace asip::model {
bool json_depth_within(std::string_view text, int limit) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > limit) return false;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return true;
}

Expected<nlohmann::json> parse_json(std::string_view text, JsonLimits limits) {
    if (text.size() > limits.max_bytes) {
        return fail("JSON is " + std::to_string(text.size()) + " bytes long, above " +
                    std::to_string(limits.max_bytes));
    }
    if (!json_depth_within(text, limits.max_depth)) {
        return fail("JSON nests deeper than " + std::to_string(limits.max_depth));
    }
    auto value = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
    if (value.is_discarded()) return fail("not valid JSON");
    return value;
}

std::string dump_json(const nlohmann::json& value) {
    return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string dump_json_pretty(const nlohmann::json& value) {
    return value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace asip::model
