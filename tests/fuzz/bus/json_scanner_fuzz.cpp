// SPDX-License-Identifier: Apache-2.0
// The scanner takes exactly what a JSON parser takes, except for deep nesting, and takes it apart as the
// parser does.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/model/json.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using asip::bus::JsonScanner;

/// The parser, which refuses numbers beyond a double.
struct Acceptor : nlohmann::json_sax<nlohmann::json> {
    bool valid = true;
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
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
        return valid = false;
    }
};

void take_apart(std::string_view text, const nlohmann::json& parsed) {
    JsonScanner scanner(text);
    std::string_view key, value;
    std::size_t count = 0;
    auto last = nlohmann::json::object();
    if (parsed.is_object()) {
        REQUIRE(scanner.enter_object());
        while (scanner.next_member(key)) {
            REQUIRE(parsed.contains(key));
            const auto name = std::string(key);
            REQUIRE(scanner.value(value) && nlohmann::json::accept(value));
            last[name] = nlohmann::json::parse(value);
            ++count;
        }
        REQUIRE(count >= parsed.size());  // a key may come twice: the last one counts
        REQUIRE(last == parsed);
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
    if (text.starts_with('\xef')) return 0;
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
    REQUIRE(scanned == acceptor.valid);
    if (!scanned) return 0;
    const auto parsed = nlohmann::json::parse(text);
    if (parsed.is_structured()) take_apart(text, parsed);
    return 0;
}
