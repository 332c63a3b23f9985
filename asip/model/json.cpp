// SPDX-License-Identifier: Apache-2.0
#include "asip/model/json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/text/file_text.hpp"

namespace asip::model {
namespace {

using nlohmann::json;

/// Reads on to where a text is no JSON.
class FaultFinder final : public json::json_sax_t {
  public:
    std::size_t byte = 0;  ///< the last one that was read, from 1

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(json::number_integer_t) override { return true; }
    bool number_unsigned(json::number_unsigned_t) override { return true; }
    bool number_float(json::number_float_t, const std::string&) override { return true; }
    bool string(std::string&) override { return true; }
    bool binary(json::binary_t&) override { return true; }
    bool start_object(std::size_t) override { return true; }
    bool key(std::string&) override { return true; }
    bool end_object() override { return true; }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t position, const std::string&, const json::exception&) override {
        byte = position;
        return false;
    }
};

std::string place_of_fault(std::string_view text) {
    FaultFinder finder;
    json::sax_parse(text.begin(), text.end(), &finder);
    const auto before = text.substr(0, finder.byte == 0 ? 0 : finder.byte - 1);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const auto start = before.rfind('\n');
    const auto column = start == before.npos ? before.size() + 1 : before.size() - start;
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

}  // namespace

bool json_depth_within(std::string_view text, int limit) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > limit) return false;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return true;
}

Expected<nlohmann::json> parse_json(std::string_view text, JsonLimits limits) {
    if (text::is_utf16(text)) return fail("JSON is in UTF-8, and this is UTF-16: save it as UTF-8");
    text = text::without_mark(text);
    if (text.size() > limits.max_bytes) {
        return fail("JSON is " + std::to_string(text.size()) + " bytes long, above " +
                    std::to_string(limits.max_bytes));
    }
    if (!json_depth_within(text, limits.max_depth))
        return fail("JSON nests deeper than " + std::to_string(limits.max_depth));
    auto value = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
    if (value.is_discarded()) return fail("not valid JSON: " + place_of_fault(text));
    return value;
}

nlohmann::json json_number(double value) {
    constexpr double kExact = 9e15;
    if (std::floor(value) == value && std::abs(value) < kExact) return static_cast<std::int64_t>(value);
    return value;
}

std::string dump_json(const nlohmann::json& value) {
    return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string dump_json_pretty(const nlohmann::json& value) {
    return value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace asip::model
