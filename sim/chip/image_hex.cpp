// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "sim/chip/image_places.hpp"

namespace asip::sim {
namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
}

/// The bytes of one record after its colon, checksum included and correct.
std::optional<std::vector<std::uint8_t>> record_bytes(std::string_view digits) {
    std::vector<std::uint8_t> bytes;
    if (digits.size() % 2 != 0) return std::nullopt;
    unsigned sum = 0;
    for (std::size_t i = 0; i < digits.size(); i += 2) {
        const int high = hex_digit(digits[i]);
        const int low = hex_digit(digits[i + 1]);
        if (high < 0 || low < 0) return std::nullopt;
        bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
        sum += bytes.back();
    }
    if (bytes.size() < 5 || bytes.size() != bytes[0] + 5u || (sum & 0xff) != 0) return std::nullopt;
    return bytes;
}

enum RecordType { kData = 0, kEnd = 1, kSegment = 2, kLinear = 4 };

}  // namespace

Expected<Image> parse_hex(const std::vector<std::uint8_t>& bytes, const std::string& name) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    Image image;
    std::size_t base = 0;
    bool ended = false;
    for (unsigned line = 1; !text.empty() && !ended; ++line) {
        const auto end = text.find('\n');
        auto record_text = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        record_text = record_text.substr(0, record_text.find_last_not_of("\r\t ") + 1);
        if (record_text.empty()) continue;

        std::optional<std::vector<std::uint8_t>> record;
        if (record_text.front() == ':') record = record_bytes(record_text.substr(1));
        if (!record) return fail(fmt::format("{}:{}: not a correct Intel .hex record", name, line));
        const auto& r = *record;
        const std::size_t address = r[1] * 256u + r[2];
        const std::size_t word = r.size() >= 7 ? r[4] * 256u + r[5] : 0;
        if (r[3] == kSegment) base = word << 4;
        if (r[3] == kLinear) base = word << 16;
        if (r[3] == kData && !place_in_flash(image, base + address, r.data() + 4, r[0]))
            return fail(fmt::format("{}:{}: address {:#x} fits no AVR", name, line, base + address));
        ended = r[3] == kEnd;
    }
    if (!ended) return fail(name + ": cut off: its end record is missing");
    if (image.flash.empty()) return fail(name + ": has no program in it");
    return image;
}

}  // namespace asip::sim
