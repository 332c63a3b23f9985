// SPDX-License-Identifier: Apache-2.0
#include "asip/property/property.hpp"

namespace asip::property {

std::string_view type_of(const Property& property) {
    switch (property.kind) {
        case Kind::kBinarySensor:
        case Kind::kSwitch:
            return "boolean";
        case Kind::kLight:
            return "light";
        case Kind::kButton:
            return "action";
        case Kind::kText:
            return "text";
        case Kind::kSelect:
            return "choice";
        default:
            break;
    }
    if (property.max_length > 0) return "text";
    if (!property.choices.empty()) return "choice";
    return property.whole ? "integer" : "number";
}

std::string_view access_of(const Property& property) {
    if (!property.settable()) return "read";
    return property.kind == Kind::kButton ? "write" : "both";
}

std::string plain_id(std::string_view id) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string plain;
    for (const char c : id) {
        const auto byte = static_cast<unsigned char>(c);
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
            plain += c;
        } else if (c == '/') {
            plain += '-';
        } else {
            plain += "--";
            plain += kDigits[byte >> 4U];
            plain += kDigits[byte & 15U];
        }
    }
    return plain;
}

}  // namespace asip::property
