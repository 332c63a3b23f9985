// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/members.hpp"

#include <algorithm>

#include "asip/bus/json/json_text.hpp"
#include "asip/model/json.hpp"

namespace asip::bus::members {

using nlohmann::json;

std::string text_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::uint64_t number_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}

double seconds_of(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number()) return 0;
    return std::clamp(found->get<double>(), -kMostSeconds, kMostSeconds);
}

bool flag_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_boolean() && found->get<bool>();
}

text::WallTime time_of(const json& object, const char* key) {
    return text::parse_iso_time(text_of(object, key)).value_or(text::WallTime{});
}

std::optional<int> int_of(const json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number_integer()) return std::nullopt;
    const auto value = found->get<std::int64_t>();
    if (value < INT32_MIN || value > INT32_MAX) return std::nullopt;
    return static_cast<int>(value);
}

void put(json& object, const char* key, const std::string& value) {
    if (!value.empty()) object[key] = value;
}

void put(json& object, const char* key, text::WallTime value) {
    if (value != text::WallTime{}) object[key] = text::iso_time(value);
}

Expected<json> object_from(std::string_view payload) {
    auto document = model::parse_json(payload, {.max_bytes = kMaxPayload, .max_depth = 40});
    if (!document) return document;
    if (!document->is_object()) return fail("not a JSON object");
    return document;
}

}  // namespace asip::bus::members
