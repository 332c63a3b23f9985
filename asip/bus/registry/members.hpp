// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/text/wall_time.hpp"

/// Members of JSON objects of registries. A missing or mistyped member is read as empty; what is empty is not
/// written.
namespace asip::bus::members {

std::string text_of(const nlohmann::json& object, const char* key);
std::uint64_t number_of(const nlohmann::json& object, const char* key);
double seconds_of(const nlohmann::json& object, const char* key);
bool flag_of(const nlohmann::json& object, const char* key);
std::optional<int> int_of(const nlohmann::json& object, const char* key);
text::WallTime time_of(const nlohmann::json& object, const char* key);

void put(nlohmann::json& object, const char* key, const std::string& value);
void put(nlohmann::json& object, const char* key, text::WallTime value);

/// In bytes, of a payload of a registry.
inline constexpr std::size_t kMaxPayload = 16u << 20;

/// Error: what it is instead.
Expected<nlohmann::json> object_from(std::string_view payload);

}  // namespace asip::bus::members
