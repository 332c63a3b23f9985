// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace asip::bus {

/// Reads a JSON text in one pass without building anything: enough to take a description apart at its first
/// level, and strict enough that what it lets through any JSON parser takes (RFC 8259, UTF-8 checked, nesting
/// at most kMaxDepth, no number beyond the range of a double).
///
/// Containers may be entered one inside the other, if the inner one is left before the outer one goes on.
/// Positions only move forward; after any function returned false the scanner is good for nothing more.
class JsonScanner {
  public:
    static constexpr int kMaxDepth = 32;

    /// A mark of UTF-8 before the text is skipped.
    explicit JsonScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {
        if (at_ != end_ && *at_ == '\xef' && text.starts_with("\xef\xbb\xbf")) at_ += 3;
    }

    /// Consumes the `{` of an object.
    bool enter_object();
    /// Consumes the next key and its colon. `key` has its escapes undone, so that `"n\u0061me"` is `name` to
    /// every reader; it is valid until the next call. False at the end of the object (then `left()`) and on a
    /// fault.
    bool next_member(std::string_view& key);
    /// That key as it is written, without the quotes.
    std::string_view raw_key() const { return raw_key_; }
    /// Consumes the `[` of an array.
    bool enter_array();
    /// Moves to the next element. False at the end of the array (then `left()`) and on a fault.
    bool next_element();
    /// True once next_member() or next_element() met the closing brace or bracket.
    bool left() const { return left_; }
    /// Consumes one value of any kind; `raw` is its text.
    bool value(std::string_view& raw);
    /// Consumes `text` if the input goes on with exactly these bytes and then ends the value.
    bool known_value(std::string_view text);
    /// Consumes `text`, the rest of an array behind one of its elements as it was read before, if the input
    /// goes on with exactly these bytes; then `left()`.
    bool known_rest(std::string_view text);
    /// What was read since `begin`, an earlier position().
    std::string_view since(const char* begin) const { return {begin, static_cast<std::size_t>(at_ - begin)}; }
    const char* position() const { return at_; }
    /// A string without escapes; false (nothing consumed) if the value is anything else.
    bool plain_string(std::string_view& text);
    /// A non-negative integer of at most 19 digits; false (nothing consumed) if the value is anything else.
    bool unsigned_integer(std::uint64_t& number);
    /// Only white space is left.
    bool at_end();

  private:
    bool enter(char open);
    bool next(char close);
    void space();
    bool skip_value(int depth);
    bool skip_string();
    bool skip_number();
    static bool is_finite(std::string_view number);
    bool skip_literal(std::string_view word);
    bool skip_utf8();
    bool skip_container(char close, int depth);

    const char* at_;
    const char* end_;
    bool first_ = true;
    bool left_ = false;
    bool escaped_ = false;  // the string that was skipped last has an escape
    std::string_view raw_key_;
    std::string unescaped_key_;
};

}  // namespace asip::bus
