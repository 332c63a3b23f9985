// SPDX-License-Identifier: Apache-2.0
// The scanner takes exactly what a JSON parser takes, except for deep nesting, and takes it apart as the
// parser does.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "asip/bus/json_scanner.hpp"
#include "asip/model/json.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using asip::bus::JsonScanner;

/// A parser that lets numbers beyond a double pass, which are JSON all the same.
struct Acceptor : nlohmann::json_sax<nlohmann::json> {
    bool valid = true;
    bool too_large = false;
    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(std::int64_t) override { return true; }
    bool number_unsigned(std::uint64_t) override { return true; }
    bool number_float(double, const std::string&) override { return true; }
    bool string(std::string&) override { return true; }
    bool binary(nlohmann::json::binary_t&) override { return true; }
    bool start_object(std::size_t) override { return true; }
    bool key(std::string&) override { return true; }
    bool end_object() override { return true; }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
        constexpr int kNumberOverflow = 406;
        too_large = error.id == kNumberOverflow;
        valid = false;
        return false;
    }
};

/// The scanner refuses numbers of more than 40 bytes.
bool has_long_number(std::string_view text) {
    std::size_t run = 0;
    for (const char c : text) {
        run =
            (c >= '0' && c <= '9') || c == '.' || c == 'e' || c == 'E' || c == '+' || c == '-' ? run + 1 : 0;
        if (run > 40) return true;
    }
    return false;
}

void take_apart(std::string_view text, const nlohmann::json& parsed) {
    JsonScanner scanner(text);
    std::string_view key, value;
    std::size_t count = 0;
    if (parsed.is_object()) {
        REQUIRE(scanner.enter_object());
        while (scanner.next_member(key)) {
            REQUIRE(scanner.value(value) && nlohmann::json::accept(value));
            ++count;
        }
        REQUIRE(count >= parsed.size());  // a key may come twice
    } else {
        REQUIRE(scanner.enter_array());
        while (scanner.next_element()) {
            REQUIRE(scanner.value(value) && nlohmann::json::parse(value) == parsed[count]);
            ++count;
        }
        REQUIRE(count == parsed.size());
    }
    REQUIRE(scanner.left() && scanner.at_end());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (!asip::model::json_depth_within(text, JsonScanner::kMaxDepth)) return 0;
    // A byte order mark is not JSON (RFC 8259); the parser passes over it.
    if (text.starts_with('\xef') || has_long_number(text)) return 0;
    JsonScanner scanner(text);
    std::string_view raw;
    const bool scanned = scanner.value(raw) && scanner.at_end();
    // The parser takes a zero byte for the end of the text; JSON has none.
    if (text.find('\0') != std::string_view::npos) {
        REQUIRE(!scanned);
        return 0;
    }
    Acceptor acceptor;
    nlohmann::json::sax_parse(text, &acceptor);
    if (acceptor.too_large) return 0;
    REQUIRE(scanned == acceptor.valid);
    if (!scanned) return 0;
    const auto parsed = nlohmann::json::parse(text);
    if (parsed.is_structured()) take_apart(text, parsed);
    return 0;
}
