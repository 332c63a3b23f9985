// SPDX-License-Identifier: Apache-2.0
#include "sim/parts/oled.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "firmware/src/asip/parts/Font.h"

namespace asip::sim {

namespace {

constexpr std::uint8_t kAddress = 0x3c;
constexpr std::size_t kWidth = 128, kHeight = 64;
constexpr std::uint8_t kContinuation = 0x80, kIsData = 0x40;
constexpr double kSettledUs = 5000;  // after the last byte, so that a change is one change

// Where text stands: 21 cells of 6 columns in 5 lines, 12 rows apart.
constexpr std::size_t kLines = 5, kRowsApart = 12, kCells = 21, kCellColumns = 6;
constexpr std::uint8_t kBarColumn = 0x3e, kEmptyColumn = 0x20;

// Commands that bytes belong to, of both data sheets.
std::size_t arguments_of(std::uint8_t command, bool addressing_modes) {
    switch (command) {
        case 0x81:
        case 0xa8:
        case 0xad:
        case 0xd3:
        case 0xd5:
        case 0xd9:
        case 0xda:
        case 0xdb:
            return 1;
        case 0x20:
        case 0x8d:
            return addressing_modes ? 1 : 0;
        case 0x21:
        case 0x22:
        case 0xa3:
            return addressing_modes ? 2 : 0;
        case 0x26:
        case 0x27:
            return addressing_modes ? 6 : 0;
        case 0x29:
        case 0x2a:
            return addressing_modes ? 5 : 0;
        default:
            return 0;
    }
}

static char read_character(const std::uint8_t* columns) {
    for (char c = kFirstGlyph; c <= kLastGlyph; ++c)
        if (columns[kGlyphColumns] == 0 &&
            std::equal(columns, columns + kGlyphColumns, kFont[c - kFirstGlyph]))
            return c;
    return '\x7f';
}

}  // namespace

Oled::Oled(std::string name, const PartKind& kind, OledController controller, PartContext& context)
    : Part(std::move(name), kind),
      context_(context),
      controller_(controller),
      settled_(context.clock, [this] { look(); }) {
    context.i2c.attach(*this);
}

PartPlan Oled::read_plan(PartReader& reader, decltype(PartPlan::make) make) {
    return {.claims = {{reader.sda(), PinUse::kBus}, {reader.scl(), PinUse::kBus}},
            .timers = 1,
            .make = std::move(make)};
}

std::uint8_t Oled::address() const {
    return kAddress;
}

bool Oled::write(std::uint8_t byte) {
    if (control_follows_) {
        is_data_ = (byte & kIsData) != 0;
        one_byte_ = (byte & kContinuation) != 0;
        control_follows_ = false;
        return true;
    }
    control_follows_ = one_byte_;
    is_data_ ? write_data(byte) : command(byte);
    settled_.at(context_.clock.cycle() + static_cast<std::uint64_t>(kSettledUs * context_.cycles_per_us));
    return true;
}

Expected<void> Oled::perform(std::string_view verb, std::string_view argument) {
    if (verb == "picture") return draw(std::string(argument));
    const auto before = state();
    attached_ = verb == "attach";
    if (attached_) power_on();
    look();
    if (state() != before) context_.changed(*this);
    return {};
}

void Oled::power_on() {
    memory_ = {};
    page_ = column_ = 0;
    columns_ = {0, 127};
    pages_ = {0, 7};
    mode_ = 2;
    on_ = false;
    flipped_columns_ = flipped_rows_ = true;
    arguments_left_ = 0;
}

Expected<void> Oled::draw(const std::string& file) const {
    if (!file.ends_with(".pbm"))
        return fail("a picture of a display is PBM, call it so: picture oled lcd.pbm");
    std::ofstream stream(file);
    stream << fmt::format("P1\n{} {}\n", kWidth, kHeight);
    for (std::size_t y = 0; y < kHeight; ++y) {
        std::string row;
        for (std::size_t x = 0; x < kWidth; ++x) {
            const bool lit =
                on_ && pixel(flipped_columns_ ? kWidth - 1 - x : x, flipped_rows_ ? kHeight - 1 - y : y);
            row += lit ? '1' : '0';
        }
        stream << row << "\n";
    }
    if (!stream.flush()) return fail(file + ": cannot be written");
    return {};
}

void Oled::write_data(std::uint8_t byte) {
    if (column_ < controller_.columns) memory_[page_][column_] = byte;
    if (mode_ == 2) {
        if (column_ < controller_.columns) ++column_;
        return;
    }
    const auto step = [](std::size_t& place, const Window& window) {
        const bool over = place >= window.last;
        place = over ? window.first : place + 1;
        return over;
    };
    if (mode_ == 0) {
        if (step(column_, columns_)) step(page_, pages_);
    } else if (step(page_, pages_)) {
        step(column_, columns_);
    }
}

void Oled::argument(std::uint8_t byte) {
    const bool is_last = --arguments_left_ == 0;
    if (argument_of_ == 0x20) mode_ = std::min<std::uint8_t>(byte & 3, 2);
    if (argument_of_ == 0x21) (is_last ? columns_.last : columns_.first) = byte & 0x7fu;
    if (argument_of_ == 0x22) (is_last ? pages_.last : pages_.first) = byte & 7u;
    if (argument_of_ == 0x21 && is_last) column_ = columns_.first;
    if (argument_of_ == 0x22 && is_last) page_ = pages_.first;
}

void Oled::command(std::uint8_t byte) {
    if (arguments_left_ != 0) return argument(byte);
    argument_of_ = byte;
    arguments_left_ = arguments_of(byte, controller_.addressing_modes);
    if (arguments_left_ != 0) return;
    if (byte <= 0x0f)
        column_ = (column_ & 0xf0u) | byte;
    else if (byte <= 0x1f)
        column_ = (column_ & 0x0fu) | static_cast<std::size_t>(byte & 0x0f) << 4;
    else if (byte >= 0xb0 && byte <= 0xb7)
        page_ = byte & 7u;
    else if (byte == 0xa0 || byte == 0xa1)
        flipped_columns_ = byte == 0xa0;
    else if ((byte & 0xf0) == 0xc0)
        flipped_rows_ = (byte & 8) == 0;
    else if (byte == 0xae || byte == 0xaf)
        on_ = byte == 0xaf;
}

void Oled::look() {
    const auto before = state();
    if (!on_)
        shown_ = "off";
    else if (flipped_columns_ || flipped_rows_)
        shown_ = "upside down";
    else
        shown_ = text();
    if (state() != before) context_.changed(*this);
}

bool Oled::pixel(std::size_t x, std::size_t y) const {
    return (memory_[y / 8][controller_.first_shown + x] >> y % 8 & 1) != 0;
}

/// Eight rows from `y` on, the top one lowest.
std::uint8_t Oled::rows(std::size_t x, std::size_t y) const {
    unsigned bits = 0;
    for (std::size_t row = 0; row < 8; ++row)
        bits |= pixel(x, y + row) ? 1u << row : 0u;
    return static_cast<std::uint8_t>(bits);
}

std::string Oled::text() const {
    std::string all;
    for (std::size_t line = 0; line < kLines; ++line) {
        std::string one = read_line(line * kRowsApart);
        one.erase(one.find_last_not_of(' ') + 1);
        if (!one.empty()) all += fmt::format("{}{}:{}", all.empty() ? "" : " ", line, one);
    }
    return all.empty() ? "blank" : all;
}

std::string Oled::read_line(std::size_t y) const {
    std::array<std::uint8_t, kCells * kCellColumns> columns{};
    for (std::size_t x = 0; x < columns.size(); ++x)
        columns[x] = rows(x, y);
    const auto empty = std::find(columns.begin(), columns.end(), kEmptyColumn);
    const bool bar = std::all_of(columns.begin(), empty, [](auto column) { return column == kBarColumn; }) &&
                     std::all_of(empty, columns.end(), [](auto column) { return column == kEmptyColumn; });
    if (bar)
        return fmt::format("[{} %]",
                           ((empty - columns.begin()) * 100 + 125) / static_cast<long>(columns.size()));
    std::string line;
    for (std::size_t cell = 0; cell < kCells; ++cell)
        line += read_character(&columns[cell * kCellColumns]);
    return line;
}

}  // namespace asip::sim
