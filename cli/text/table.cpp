// SPDX-License-Identifier: Apache-2.0
#include "cli/text/table.hpp"

#include <algorithm>
#include <numeric>

#include "cli/text/terminal_buffer.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

constexpr std::size_t kGap = 2;
constexpr std::size_t kFirstText = 1u << 20;  // bytes; more only as they come

const char* code_of(Colour colour) {
    switch (colour) {
        case Colour::kBold:
            return "[1m";
        case Colour::kDim:
            return "[2m";
        case Colour::kRed:
            return "[31m";
        case Colour::kGreen:
            return "[32m";
        case Colour::kYellow:
            return "[33m";
        case Colour::kCyan:
            return "[36m";
        case Colour::kNone:
            break;
    }
    return "";
}

}  // namespace

std::string painted(std::string_view text, Colour colour, bool on) {
    if (!on || colour == Colour::kNone || text.empty()) return std::string(text);
    return own_control('\033') + code_of(colour) + std::string(text) + own_control('\033') + "[0m";
}

void Table::add(const std::vector<Cell>& row) {
    for (std::size_t i = 0; i < columns_.size(); ++i)
        if (i < row.size())
            add_cell(row[i].text, row[i].colour);
        else
            add_cell({});
}

void Table::add_cell(std::string_view text, Colour colour) {
    text = text.substr(0, kMaxCell);
    const auto columns = columns_.size();
    if (cells_.size() >= columns) {
        const auto above = cells_[cells_.size() - columns];
        if (text_of(above) == text) {
            cells_.push_back(above);
            cells_.back().colour = static_cast<unsigned>(colour) & 0xFU;
            return;
        }
    }
    Shown cell;
    cell.begin = texts_.size();
    if (is_plain(text))
        texts_ += text;
    else
        texts_ += for_terminal(text);
    cell.size = static_cast<std::uint32_t>(texts_.size() - cell.begin);
    cell.width = static_cast<std::uint32_t>(display_width(text_of(cell)) & 0xFFFFFFFU);
    cell.colour = static_cast<unsigned>(colour) & 0xFU;
    cells_.push_back(cell);
}

void Table::add_cells_above(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        const auto above = cells_[cells_.size() - columns_.size()];
        cells_.push_back(above);
    }
}

void Table::measure(std::size_t limit) {
    auto& result = widths_;
    const auto columns = columns_.size();
    result.resize(columns);
    limited_ = limit != 0;
    for (std::size_t i = 0; i < columns; ++i) {
        std::size_t width = std::max(result[i], display_width(columns_[i].header));
        const bool may_be_cut = limited_ && columns_[i].least != 0;
        for (std::size_t cell = rendered_ + i; cell < cells_.size(); cell += columns) {
            const std::size_t whole = cells_[cell].width;
            if (may_be_cut)
                width = std::max(width, std::min(whole, limit));
            else if (whole <= kMaxAligned)
                width = std::max(width, whole);
        }
        result[i] = width;
    }
    if (!limited_) return;
    std::size_t total = std::accumulate(result.begin(), result.end(), kGap * (columns - 1));
    while (total > limit) {
        // The widest column that still may shrink gives one: what is short stays whole longest.
        std::size_t widest = columns;
        for (std::size_t i = 0; i < columns; ++i) {
            if (columns_[i].least == 0 || result[i] <= columns_[i].least) continue;
            if (widest == columns || result[i] > result[widest]) widest = i;
        }
        if (widest == columns) break;
        --result[widest];
        --total;
    }
}

void Table::append_cell(std::string& line, std::string_view shown, std::size_t whole, Colour colour,
                        std::size_t column, bool last) const {
    const auto width = widths_[column];
    const bool right = columns_[column].right;
    std::string cut;
    if (whole > width && limited_ && columns_[column].least != 0) {
        cut = fit(shown, width);
        shown = cut;
        whole = display_width(cut);
    }
    const auto blanks = whole < width ? width - whole : 0;
    if (right) line.append(blanks, ' ');
    if (colour != Colour::kNone)
        line += painted(shown, colour, true);
    else
        line += shown;
    if (!last) line.append((right ? 0 : blanks) + kGap, ' ');
}

void Table::append_header(std::string& text, bool colour) const {
    std::size_t last = columns_.size();
    while (last > 0 && columns_[last - 1].header.empty())
        --last;
    for (std::size_t i = 0; i < last; ++i) {
        const std::string_view header = columns_[i].header;
        append_cell(text, header, display_width(header), colour ? Colour::kBold : Colour::kNone, i,
                    i + 1 == last);
    }
    text += '\n';
}

/// Boards of a fleet often differ in nothing but their name: what stands behind the first cell is then copied
/// from the line above.
void Table::append_rows(std::string& text, std::size_t first, bool colour) const {
    const auto columns = columns_.size();
    std::size_t rest = 0;  // of the line above, in `text`
    std::size_t rest_size = 0;
    for (std::size_t row = first; row + columns <= cells_.size(); row += columns) {
        const auto* cells = &cells_[row];
        const bool same = row != first && std::equal(cells + 1, cells + columns, cells + 1 - columns);
        std::size_t last = columns;
        while (last > 0 && cells[last - 1].size == 0)
            --last;
        std::size_t behind_first = text.size();
        for (std::size_t i = 0; i < (same ? std::min<std::size_t>(last, 1) : last); ++i) {
            append_cell(text, text_of(cells[i]), cells[i].width,
                        colour ? static_cast<Colour>(cells[i].colour) : Colour::kNone, i, i + 1 == last);
            if (i == 0) behind_first = text.size();
        }
        if (same)
            text.append(text, rest, rest_size);
        else
            text += '\n';
        rest = behind_first;
        rest_size = text.size() - behind_first;
    }
}

std::string Table::render(std::size_t width, bool colour) {
    widths_.clear();
    rendered_ = 0;
    measure(width);
    rendered_ = cells_.size();
    std::string text;
    const auto line = std::accumulate(widths_.begin(), widths_.end(), kGap * columns_.size());
    text.reserve(std::min((cells_.size() / columns_.size() + 1) * line, kFirstText));
    append_header(text, colour);
    append_rows(text, 0, colour);
    return text;
}

std::string Table::render_more(std::size_t width, bool colour) {
    measure(width);
    std::string text;
    append_rows(text, rendered_, colour);
    cells_.clear();
    texts_.clear();
    rendered_ = 0;
    return text;
}

}  // namespace asip::cli
