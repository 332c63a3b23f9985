// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace asip::cli {

enum class Colour { kNone, kBold, kDim, kRed, kGreen, kYellow, kCyan };

/// `text` in `colour`, if `on`; else as it is.
std::string painted(std::string_view text, Colour colour, bool on);

struct Cell {
    std::string text;
    Colour colour = Colour::kNone;

    Cell(std::string t = {}, Colour c = Colour::kNone)
        : text(std::move(t)), colour(c) {}  // NOLINT: cells are texts
    Cell(const char* t) : text(t) {}        // NOLINT
};

struct Column {
    std::string header;
    bool right = false;  ///< numbers line up at their last digit
    /// Columns this one keeps when the table is wider than the terminal; 0: never cut.
    std::size_t least = 0;
};

/// Text in columns, for people. Cells are shown through for_terminal().
class Table {
  public:
    explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

    /// One cell a column; missing ones are empty.
    void add(std::vector<Cell> row);
    bool empty() const { return rows_.empty(); }

    /// The table with a header line, each line ended by a newline and without trailing blanks. No line is
    /// wider than `width` terminal columns as long as the columns that may be cut suffice; 0 means no limit.
    std::string render(std::size_t width, bool colour);
    /// Only the rows added since they were rendered last, in the columns of before, without a header.
    std::string render_more(std::size_t width, bool colour);

  private:
    void measure(std::size_t limit);
    std::string lines(const std::vector<std::vector<Cell>>& rows, bool colour) const;

    std::vector<Column> columns_;
    std::vector<std::vector<Cell>> rows_;
    std::vector<std::size_t> widths_;
    std::size_t rendered_ = 0;
};

}  // namespace asip::cli
