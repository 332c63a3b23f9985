// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace asip::cli {

/// One character a value, from the lowest of them to the highest of them; values that are all the same are a
/// low line.
std::string sparkline(std::span<const double> values);

/// The first number in a value of a service, depth first; nothing where there is none.
std::optional<double> first_number(const nlohmann::json& value);

}  // namespace asip::cli
