// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace asip::bus {

/// Reads JSON in one pass without building anything, as strict as any parser (RFC 8259, UTF-8 checked,
/// nesting at most kMaxDepth, numbers within a double).
/// Containers may be entered inside each other, if the inner one is left first. Positions only move forward;
/// once a function returned false the scanner is of no use.
class JsonScanner {
  public:
    static constexpr int kMaxDepth = 32;

    /// A mark of UTF-8 before the text is skipped.
    explicit JsonScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {
        if (at_ != end_ && *at_ == '\xef' && text.starts_with("\xef\xbb\xbf")) at_ += 3;
    }

    bool enter_object();
    /// Consumes the next key and its colon. `key` has its escapes undone, and is valid until the next call.
    /// False: the end of the object (then `left()`), or a fault.
    bool next_member(std::string_view& key);
    /// As it is written, without the quotes.
    std::string_view raw_key() const { return raw_key_; }
    bool enter_array();
    /// False: the end of the array (then `left()`), or a fault.
    bool next_element();
    /// next_member() or next_element() met the closing bracket.
    bool left() const { return left_; }
    /// `raw`: its text.
    bool value(std::string_view& raw);
    /// Consumes `text` if exactly these bytes come and end the value.
    bool known_value(std::string_view text);
    /// Consumes `text`, the rest of an array as it was read before, if exactly these bytes come; then
    /// `left()`.
    bool known_rest(std::string_view text);
    /// `begin`: an earlier position().
    std::string_view since(const char* begin) const { return {begin, static_cast<std::size_t>(at_ - begin)}; }
    const char* position() const { return at_; }
    /// False, and nothing consumed: the value is no string without escapes.
    bool plain_string(std::string_view& text);
    /// False, and nothing consumed: the value is no non-negative integer of at most 19 digits.
    bool unsigned_integer(std::uint64_t& number);
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
