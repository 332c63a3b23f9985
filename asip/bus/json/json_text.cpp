// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/json/json_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/model/json.hpp"

namespace asip::bus {

namespace {

bool is_plain(unsigned char c) {
    return c >= 0x20 && c < 0x7F && c != '"' && c != '\\';
}

}  // namespace

void append_json_text(std::string& out, std::string_view text) {
    const auto start = out.size();
    out += '"';
    std::size_t written = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (is_plain(static_cast<unsigned char>(text[i]))) continue;
        if (text[i] != '"' && text[i] != '\\') {
            out.resize(start);
            out += model::dump_json(text);
            return;
        }
        out.append(text, written, i - written) += '\\';
        written = i;
    }
    out.append(text, written) += '"';
}

void append_json_seconds(std::string& out, double seconds) {
    const double bounded = std::isfinite(seconds) ? std::clamp(seconds, -kMostSeconds, kMostSeconds) : 0;
    const auto milliseconds = static_cast<std::int64_t>(bounded * 1000);
    const auto size = static_cast<std::uint64_t>(milliseconds < 0 ? -milliseconds : milliseconds);
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, size / 1000);
    if (milliseconds < 0) out += '-';
    out.append(digits, end.ptr);
    if (size % 1000 == 0) return;
    const std::string thousandths = std::to_string(1000 + size % 1000);
    out += '.';
    out.append(thousandths, 1, thousandths.find_last_not_of('0'));
}

std::string_view written_member(std::string_view payload, std::string_view name) {
    JsonScanner scanner(payload);
    std::string_view found;
    std::string_view key;
    if (!scanner.enter_object()) return {};
    while (scanner.next_member(key)) {
        const bool wanted = key == name;
        std::string_view value;
        if (!scanner.value(value)) break;
        if (wanted) found = value;
    }
    return found;
}

void keep_numbers(std::string_view payload, nlohmann::json& object,
                  std::initializer_list<std::string_view> names) {
    for (const auto name : names) {
        const auto member = object.find(name);
        if (member == object.end() || !member->is_number_float()) continue;
        if (const auto written = written_member(payload, name); !written.empty())
            *member = std::string(written);
    }
}

}  // namespace asip::bus
