// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/protocol/limits.hpp"

namespace asip::protocol {

/// Cuts bytes into lines ended by `
/// `, or by any of `ends`; a `\r` before it and empty lines are dropped. A line above the limit is dropped
/// and counted.
class LineReader {
  public:
    /// `max_line_bytes`: without line end.
    explicit LineReader(std::size_t max_line_bytes = kMaxBoardLineBytes, std::string_view ends = "\n");

    /// The view is valid during the call only. `on_line` must not call push(); it may call reset(), which
    /// forgets the partial line but not the rest of `bytes`.
    template <class OnLine>
    void push(std::string_view bytes, OnLine&& on_line) {
        while (take_line(bytes)) {
            const std::string line = std::move(line_);
            line_.clear();
            on_line(std::string_view(line));
        }
    }

    /// Forgets a partial line.
    void reset();

    /// Bytes of the line that has not ended.
    void drop(std::size_t bytes) { line_.erase(0, bytes); }
    /// 0 while an overlong line is dropped.
    std::size_t partial_bytes() const { return line_.size(); }
    /// Valid until the next push() or reset().
    std::string_view partial() const { return line_; }
    /// Since construction.
    std::uint64_t overlong_lines() const { return overlong_lines_; }

    bool operator==(const LineReader&) const = default;

  private:
    /// Up to one line end; true: line_ holds a complete, non-empty line.
    bool take_line(std::string_view& bytes);

    std::size_t max_line_bytes_;
    std::string_view ends_;
    std::string line_;
    bool dropping_ = false;
    std::uint64_t overlong_lines_ = 0;
};

}  // namespace asip::protocol
