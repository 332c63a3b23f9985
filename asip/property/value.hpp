// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "asip/property/property.hpp"

/// A value is JSON: true or false (binary sensor, switch), a number (sensor, number), a text (text, sensor),
/// a word (select), {"on":true,"brightness":0..255,"color":0xrrggbb} of a light; `null`: the board says that
/// it has none. What stands on the wire is called raw here.
namespace asip::property {

/// The value of a straight line through two points (model::Meaning::line) at `raw`, to six digits.
double on_line(const std::array<double, 4>& line, double raw);

/// The value behind a raw one. Nothing: it is none that the property can have.
std::optional<nlohmann::json> value_of(const Property& property, const nlohmann::json& raw);
/// Whether there is one.
bool has_value(const Property& property, const nlohmann::json& raw);

/// The raw value in what a service published on `out`; nothing: it is not in there. Any JSON may be given.
const nlohmann::json* raw_in(const Place& place, const nlohmann::json& published);
/// The value in there. Nothing: none is, or none that the property can have.
std::optional<nlohmann::json> value_in(const Property& property, const nlohmann::json& published);

/// Of a light, by the raw values that its calls set; nothing: the one that says whether it is on is not
/// known.
std::optional<nlohmann::json> light_of(const Property& property, std::optional<double> level,
                                       std::optional<double> color);

/// What a switch or a slider asks for, as a value of the property; of a light it is whether it is on, or its
/// brightness.
nlohmann::json value_of_control(const Property& property, const nlohmann::json& wanted);

/// A command as it goes to a service: {"write":[0,90]}.
struct Request {
    std::string service;
    std::string payload;
    friend bool operator==(const Request&, const Request&) = default;
};

/// What sets a property to a value, in order. Empty: no such value, or it cannot be set.
std::vector<Request> requests_for(const Property& property, const nlohmann::json& value);

}  // namespace asip::property
