// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/protocol/limits.hpp"

namespace asip::protocol {

/// Cuts a byte stream into lines ended by `\n`, or by any of `ends`; a `\r` before it is dropped, empty lines
/// are skipped. Any bytes may be given, in pieces of any size. A line longer than the limit is dropped to its
/// end and counted, and the next one is read as usual; memory never exceeds the limit.
class LineReader {
  public:
    /// `max_line_bytes`: without the line end. `ends` outlives the reader.
    explicit LineReader(std::size_t max_line_bytes = kMaxBoardLineBytes, std::string_view ends = "\n");

    /// Calls `on_line(std::string_view)` for each line that these bytes complete. The view is valid during
    /// the call only. `on_line` must not call push(); it may call reset(), which forgets the partial line but
    /// not the rest of `bytes`.
    template <class OnLine>
    void push(std::string_view bytes, OnLine&& on_line) {
        while (take_line(bytes)) {
            const std::string line = std::move(line_);
            line_.clear();
            on_line(std::string_view(line));
        }
    }

    /// Forgets a partial line, for example when the port was opened again.
    void reset();

    /// Forgets the first bytes of the line that has not ended yet.
    void drop(std::size_t bytes) { line_.erase(0, bytes); }
    /// Bytes of the line that has not ended yet (0 while an overlong one is being dropped).
    std::size_t partial_bytes() const { return line_.size(); }
    /// The line that has not ended yet; valid until the next call of push() or reset().
    std::string_view partial() const { return line_; }
    /// How many lines were dropped since construction.
    std::uint64_t overlong_lines() const { return overlong_lines_; }

  private:
    /// Consumes bytes up to and including one line end; true when line_ holds a complete, non-empty line.
    bool take_line(std::string_view& bytes);

    std::size_t max_line_bytes_;
    std::string_view ends_;
    std::string line_;
    bool dropping_ = false;
    std::uint64_t overlong_lines_ = 0;
};

}  // namespace asip::protocol
