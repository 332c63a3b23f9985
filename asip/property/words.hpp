// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "asip/property/known_values.hpp"
#include "asip/property/property.hpp"

/// Values for people.
namespace asip::property {

/// "42 cm", "on", "pressed", "open", "45 degrees", "on, 128 of 255, #ff0000", "none". `raw`: without the
/// unit.
std::string value_text(const Property& property, const nlohmann::json& value, bool raw = false);
/// "unknown: nothing was reported or set yet".
std::string unknown_text(Unknown why);

/// The one of this id, else those below it ("servo/0", "io").
std::vector<std::size_t> properties_named(const std::vector<Property>& properties, std::string_view id);

}  // namespace asip::property
