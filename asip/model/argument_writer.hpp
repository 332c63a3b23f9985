// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

/// Strict: a number in JSON is a number. Lenient: what a person typed or the wire carries, numbers come as
/// text.
enum class Strictness { kStrict, kLenient };

/// A number, the number of a name or a color; whether it is within bounds is not asked.
std::optional<double> number_of(const Field& field, const nlohmann::json& value, Strictness strictness);

/// One value as it stands on the wire. `place` names it in the reason: "angle", "pixels/0/color".
Expected<std::string> write_value(const Field& field, const nlohmann::json& value, Strictness strictness,
                                  const std::string& place);

/// All arguments of a command, each with its comma before it: ",0,90". `values` holds one value for each
/// argument that is no Count, in order. A list is an array of items; an item is a value, an array or object
/// of its fields, or text "0:255".
Expected<std::string> write_arguments(const CommandModel& command, const nlohmann::json& values,
                                      Strictness strictness);

}  // namespace asip::model
