// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace asip::cli {

enum class Colour : std::uint8_t { kNone, kBold, kDim, kRed, kGreen, kYellow, kCyan };

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

/// Text in columns, for people. Cells are shown through for_terminal(), and at most kMaxCell bytes of each. A
/// cell wider than kMaxAligned terminal columns stands out of its column: one of them must not widen all
/// rows.
class Table {
  public:
    static constexpr std::size_t kMaxCell = 64u << 20;
    static constexpr std::size_t kMaxAligned = 1000;

    explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

    /// One cell a column; missing ones are empty.
    void add(const std::vector<Cell>& row);
    /// The next cell of a row that is added from left to right: the row is whole with as many as there are
    /// columns.
    void add_cell(std::string_view text, Colour colour = Colour::kNone);
    /// The next `count` cells are those above them: there must be a row.
    void add_cells_above(std::size_t count);
    void reserve(std::size_t rows) { cells_.reserve(rows * columns_.size()); }
    bool empty() const { return cells_.empty(); }

    /// The table with a header line, each line ended by a newline and without trailing blanks. No line is
    /// wider than `width` terminal columns as long as the columns that may be cut suffice; 0 means no limit.
    std::string render(std::size_t width, bool colour);
    /// Only the rows added since they were rendered last, in the columns of before, without a header.
    std::string render_more(std::size_t width, bool colour);

  private:
    /// A cell as it is shown; one that looks like that above it has the same text.
    struct Shown {
        std::size_t begin = 0;  ///< in texts_
        std::uint32_t size = 0;
        std::uint32_t width : 28 = 0;
        std::uint32_t colour : 4 = 0;

        bool operator==(const Shown&) const = default;
    };

    std::string_view text_of(const Shown& cell) const { return {texts_.data() + cell.begin, cell.size}; }
    void measure(std::size_t limit);
    void append_header(std::string& text, bool colour) const;
    void append_rows(std::string& text, std::size_t first, bool colour) const;
    void append_cell(std::string& line, std::string_view shown, std::size_t whole, Colour colour,
                     std::size_t column, bool last) const;

    std::vector<Column> columns_;
    std::vector<Shown> cells_;  ///< row by row
    std::string texts_;
    std::vector<std::size_t> widths_;
    bool limited_ = false;      ///< the widths are those of a terminal
    std::size_t rendered_ = 0;  ///< cells
};

}  // namespace asip::cli
