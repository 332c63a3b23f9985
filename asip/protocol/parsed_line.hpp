// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <utility>

#include "asip/protocol/message.hpp"

namespace asip::protocol {

/// One line from a board together with what parse_line() found in it. It owns its text, so that it can be
/// kept and passed on without parsing the line again. Copies and moves are independent of each other.
class ParsedLine {
  public:
    ParsedLine() = default;
    /// Parses `line`, which has no line end.
    explicit ParsedLine(std::string line);
    /// `message` is what parse_line(line) returned for this very `line`.
    ParsedLine(std::string_view line, const Message& message);

    /// The whole line.
    const std::string& text() const { return text_; }
    bool empty() const { return text_.empty(); }

    // Info and malformed lines are neither.
    bool is_event() const { return kind_ == Kind::kEvent; }
    bool is_error() const { return kind_ == Kind::kError; }

    /// The views in these point into text() and are valid as long as this line is neither changed, moved nor
    /// destroyed. Call each only where the line is of that kind.
    Event event() const { return {service_, tag_, std::string_view(text_).substr(part_at_, part_size_)}; }
    ErrorReply error() const {
        return {service_, tag_, code_, std::string_view(text_).substr(part_at_, part_size_)};
    }

  private:
    enum class Kind : unsigned char { kOther, kEvent, kError };

    void keep(const Message& message, std::string_view line);

    std::string text_;
    Kind kind_ = Kind::kOther;
    char service_ = 0;
    char tag_ = 0;
    int code_ = 0;
    std::size_t part_at_ = 0;  // the event's body, or the error's text
    std::size_t part_size_ = 0;
};

}  // namespace asip::protocol
