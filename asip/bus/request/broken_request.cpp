// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/broken_request.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace asip::bus {
namespace {

using nlohmann::json;

constexpr int kMaxNumbers = 8;        // the text is read anew after each
constexpr int kNumberTooLarge = 406;  // of the library's exceptions

/// Notes the members that say where an answer goes, up to the first fault.
class ReplyMembers final : public json::json_sax_t {
  public:
    json members = json::object();
    bool number_too_large = false;
    std::size_t fault_end = 0;  ///< of the token at which it stopped
    std::size_t fault_bytes = 0;

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(json::number_integer_t value) override { return note(value); }
    bool number_unsigned(json::number_unsigned_t value) override { return note(value); }
    bool number_float(json::number_float_t value, const std::string&) override { return note(value); }
    bool string(std::string& value) override { return note(std::move(value)); }
    bool binary(json::binary_t&) override { return true; }
    bool start_object(std::size_t) override { return ++depth_, true; }
    bool end_object() override { return --depth_, true; }
    bool start_array(std::size_t) override { return ++depth_, true; }
    bool end_array() override { return --depth_, true; }
    bool key(std::string& name) override {
        if (depth_ == 1) key_ = name;
        return true;
    }
    bool parse_error(std::size_t position, const std::string& token, const json::exception& fault) override {
        number_too_large = fault.id == kNumberTooLarge;
        fault_end = position;
        fault_bytes = token.size();
        return false;
    }

  private:
    template <class Value>
    bool note(Value&& value) {
        constexpr std::array<std::string_view, 3> kWanted{"reply_to", "id", "by"};
        if (depth_ == 1 && std::find(kWanted.begin(), kWanted.end(), key_) != kWanted.end())
            members[key_] = std::forward<Value>(value);
        return true;
    }
    int depth_ = 0;
    std::string key_;
};

}  // namespace

BrokenRequest read_broken_request(std::string text) {
    constexpr std::string_view kNothing = "null";
    std::string error = "the request is not valid JSON";
    for (int number = 0;; ++number) {
        ReplyMembers reader;
        const bool whole = json::sax_parse(text, &reader);
        const bool goes_on = reader.number_too_large && number < kMaxNumbers &&
                             reader.fault_bytes >= kNothing.size() &&
                             reader.fault_bytes <= reader.fault_end && reader.fault_end <= text.size();
        if (whole || !goes_on) return {std::move(reader.members), std::move(error)};
        error = "a number in the request is too large";
        const auto start = reader.fault_end - reader.fault_bytes;
        std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(start), reader.fault_bytes, ' ');
        text.replace(start, kNothing.size(), kNothing);
    }
}

}  // namespace asip::bus
