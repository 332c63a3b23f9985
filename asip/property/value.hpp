// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "asip/property/property.hpp"

/// A value is JSON: true or false (binary sensor, switch), a number (sensor, number), a text (text, sensor),
/// a word (select), {"on":true,"brightness":0..255,"color":0xrrggbb} of a light; `null`: the board has none.
/// A raw value is that of the wire.
namespace asip::property {

/// An object that is no light is no value.
bool is_light_value(const nlohmann::json& value);

/// On the line through two points (model::Meaning::line), to six digits.
double on_line(const std::array<double, 4>& line, double raw);

/// Nothing: the property cannot have it.
std::optional<nlohmann::json> value_of(const Property& property, const nlohmann::json& raw);
bool has_value(const Property& property, const nlohmann::json& raw);

/// In what a service published on `out`, any JSON; null: it is not there.
const nlohmann::json* raw_in(const Place& place, const nlohmann::json& published);
/// Nothing: not there, or not one that the property can have.
std::optional<nlohmann::json> value_in(const Property& property, const nlohmann::json& published);

/// From the raw values that a light's calls set; nothing: whether it is on is not known.
std::optional<nlohmann::json> light_of(const Property& property, std::optional<double> level,
                                       std::optional<double> color);

/// From a switch or a slider; for a light, on or off, or brightness.
nlohmann::json value_of_control(const Property& property, const nlohmann::json& wanted);

/// As it goes to a service: {"write":[0,90]}.
struct Request {
    std::string service;
    std::string payload;
    friend bool operator==(const Request&, const Request&) = default;
};

/// In order. Empty: no such value, or it cannot be set.
std::vector<Request> requests_for(const Property& property, const nlohmann::json& value);

}  // namespace asip::property
