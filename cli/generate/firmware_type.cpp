// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/firmware_type.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "cli/generate/layout.hpp"

namespace asip::generate {

using model::Field;
using model::ValueType;

std::string firmware_type(const Field& field) {
    if (field.type == ValueType::kText) return "const char*";
    if (field.type == ValueType::kNumber) return "float";
    const auto range = whole_range(field);
    if (range.fits(0, kMaxUnsigned16Bits)) return "uint16_t";
    if (range.fits(-kMaxSigned16Bits, kMaxSigned16Bits)) return "int16_t";
    return "int32_t";
}

std::string firmware_write(const Field& field, const std::string& value) {
    if (field.type == ValueType::kText) return fmt::format("text({})", value);
    if (field.type == ValueType::kNumber) return fmt::format("hundredths(lround({} * 100))", value);
    const auto type = firmware_type(field);
    if (type == "uint16_t") return fmt::format("number({})", value);
    return fmt::format("{}({})", type == "int16_t" ? "signedNumber" : "signedLongNumber", value);
}

std::string whole_literal(double bound) {
    if (bound == std::numeric_limits<std::int32_t>::min()) return "INT32_MIN";
    return fmt::format("{:.0f}", bound);
}

std::string decimal_literal(double bound) {
    auto text = fmt::format("{:.9g}", bound);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text + "f";
}

}  // namespace asip::generate
