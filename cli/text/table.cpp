// SPDX-License-Identifier: Apache-2.0
#include "cli/text/table.hpp"

#include <algorithm>
#include <numeric>

#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

constexpr std::size_t kGap = 2;

const char* code_of(Colour colour) {
    switch (colour) {
        case Colour::kBold:
            return "\033[1m";
        case Colour::kDim:
            return "\033[2m";
        case Colour::kRed:
            return "\033[31m";
        case Colour::kGreen:
            return "\033[32m";
        case Colour::kYellow:
            return "\033[33m";
        case Colour::kCyan:
            return "\033[36m";
        case Colour::kNone:
            break;
    }
    return "";
}

void append_cell(std::string& line, const Cell& cell, const Column& column, std::size_t width, bool last,
                 bool colour) {
    const auto whole = display_width(cell.text);
    std::string cut;
    if (whole > width) cut = fit(cell.text, width);
    const std::string& text = whole > width ? cut : cell.text;
    const auto blanks = width - (whole > width ? display_width(cut) : whole);
    if (column.right) line.append(blanks, ' ');
    if (colour && cell.colour != Colour::kNone) {
        line += painted(text, cell.colour, colour);
    } else {
        line += text;
    }
    if (last) return;
    line.append((column.right ? 0 : blanks) + kGap, ' ');
}

}  // namespace

std::string painted(std::string_view text, Colour colour, bool on) {
    if (!on || colour == Colour::kNone || text.empty()) return std::string(text);
    return code_of(colour) + std::string(text) + "\033[0m";
}

void Table::add(std::vector<Cell> row) {
    row.resize(columns_.size());
    for (auto& cell : row) {
        if (!is_plain(cell.text)) cell.text = for_terminal(cell.text);
    }
    rows_.push_back(std::move(row));
}

void Table::measure(std::size_t limit) {
    auto& result = widths_;
    result.resize(columns_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        std::size_t width = std::max(result[i], display_width(columns_[i].header));
        for (std::size_t row = rendered_; row < rows_.size(); ++row) {
            width = std::max(width, display_width(rows_[row][i].text));
        }
        result[i] = width;
    }
    if (limit == 0) return;
    std::size_t total = std::accumulate(result.begin(), result.end(), kGap * (columns_.size() - 1));
    while (total > limit) {
        // The widest column that still may shrink gives one: what is short stays whole longest.
        std::size_t widest = columns_.size();
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            if (columns_[i].least == 0 || result[i] <= columns_[i].least) continue;
            if (widest == columns_.size() || result[i] > result[widest]) widest = i;
        }
        if (widest == columns_.size()) break;
        --result[widest];
        --total;
    }
}

std::string Table::lines(const std::vector<std::vector<Cell>>& rows, bool colour) const {
    std::string text;
    for (const auto& row : rows) {
        std::size_t last = row.size();
        while (last > 0 && row[last - 1].text.empty())
            --last;
        for (std::size_t i = 0; i < last; ++i)
            append_cell(text, row[i], columns_[i], widths_[i], i + 1 == last, colour);
        text += '\n';
    }
    return text;
}

std::string Table::render(std::size_t width, bool colour) {
    widths_.clear();
    rendered_ = 0;
    std::vector<Cell> header;
    for (const auto& column : columns_)
        header.emplace_back(column.header, Colour::kBold);
    measure(width);
    rendered_ = rows_.size();
    return lines({header}, colour) + lines(rows_, colour);
}

std::string Table::render_more(std::size_t width, bool colour) {
    measure(width);
    std::vector<std::vector<Cell>> fresh(rows_.begin() + static_cast<std::ptrdiff_t>(rendered_), rows_.end());
    rows_.clear();
    rendered_ = 0;
    return lines(fresh, colour);
}

}  // namespace asip::cli
