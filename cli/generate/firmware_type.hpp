// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/model/service_model.hpp"

/// Values of a service model in the C++ of a board.
namespace asip::generate {

inline constexpr double kMaxUnsigned16Bits = 65535;
inline constexpr double kMaxSigned16Bits = 32767;

/// In which the firmware keeps a value.
std::string firmware_type(const model::Field& field);
/// How `out` writes a value: `number(VALUE)`.
std::string firmware_write(const model::Field& field, const std::string& value);
/// As a literal of C++.
std::string whole_literal(double bound);
std::string decimal_literal(double bound);

}  // namespace asip::generate
