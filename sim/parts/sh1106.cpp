// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/src/asip/Font.h"
#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

const PartKind& sh1106_part();

namespace {

// Of the data sheet of the SH1106: 132 columns of memory, of which the usual glass shows 128.
constexpr std::uint8_t kAddress = 0x3c;
constexpr std::size_t kColumns = 132, kFirstShown = 2, kPages = 8;
constexpr std::uint8_t kContinuation = 0x80, kIsData = 0x40;

// Where text stands: 21 cells of 6 columns in 5 lines, 12 rows apart.
constexpr std::size_t kLines = 5, kRowsApart = 12, kCells = 21, kCellColumns = 6;
constexpr std::uint8_t kBarColumn = 0x3e, kEmptyColumn = 0x20;

/// A display of 128 x 64 pixels. It reads what it shows: text in the font of this project's firmware, and
/// bars.
class Sh1106 final : public Part, public I2cDevice {
  public:
    Sh1106(std::string name, int, PartContext& context)
        : Part(std::move(name), sh1106_part()),
          context_(context),
          settled_(context.clock, [this] { look(); }) {
        context.i2c.attach(*this);
    }

    /// The lines that are not empty: `0:Hello 3:[50 %]`; "off" and "upside down" for a display that is.
    std::string state() const override { return attached_ ? shown_ : "detached"; }

    std::uint8_t address() const override { return kAddress; }
    bool is_there() const override { return attached_; }
    void started(bool reading) override {
        if (!reading) control_follows_ = true;
    }
    std::uint8_t read() override { return on_ ? 0 : 0x40; }

    bool write(std::uint8_t byte) override {
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

  private:
    static constexpr double kSettledUs = 5000;  // after the last byte, so that a change is one change

    Expected<void> perform(std::string_view verb, std::string_view) override {
        const auto before = state();
        attached_ = verb == "attach";
        if (attached_) {
            memory_ = {};
            on_ = false;
            flipped_columns_ = flipped_rows_ = true;
            argument_of_ = 0;
        }
        look();
        if (state() != before) context_.changed(*this);
        return {};
    }

    void write_data(std::uint8_t byte) {
        if (column_ < kColumns) memory_[page_][column_++] = byte;
    }

    void command(std::uint8_t byte) {
        if (argument_of_ != 0) {
            argument_of_ = 0;
            return;
        }
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
        else if (std::find(kWithArgument.begin(), kWithArgument.end(), byte) != kWithArgument.end())
            argument_of_ = byte;
    }
    static constexpr std::array<std::uint8_t, 8> kWithArgument{0x81, 0xa8, 0xad, 0xd3,
                                                               0xd5, 0xd9, 0xda, 0xdb};

    void look() {
        const auto before = state();
        if (!on_)
            shown_ = "off";
        else if (flipped_columns_ || flipped_rows_)
            shown_ = "upside down";
        else
            shown_ = text();
        if (state() != before) context_.changed(*this);
    }

    bool pixel(std::size_t x, std::size_t y) const {
        return (memory_[y / 8][kFirstShown + x] >> y % 8 & 1) != 0;
    }

    /// Eight rows from `y` on, the top one lowest.
    std::uint8_t rows(std::size_t x, std::size_t y) const {
        unsigned bits = 0;
        for (std::size_t row = 0; row < 8; ++row)
            bits |= pixel(x, y + row) ? 1u << row : 0u;
        return static_cast<std::uint8_t>(bits);
    }

    std::string text() const {
        std::string all;
        for (std::size_t line = 0; line < kLines; ++line) {
            std::string one = read_line(line * kRowsApart);
            one.erase(one.find_last_not_of(' ') + 1);
            if (!one.empty()) all += fmt::format("{}{}:{}", all.empty() ? "" : " ", line, one);
        }
        return all.empty() ? "blank" : all;
    }

    std::string read_line(std::size_t y) const {
        std::array<std::uint8_t, kCells * kCellColumns> columns{};
        for (std::size_t x = 0; x < columns.size(); ++x)
            columns[x] = rows(x, y);
        const auto empty = std::find(columns.begin(), columns.end(), kEmptyColumn);
        const bool bar =
            std::all_of(columns.begin(), empty, [](auto column) { return column == kBarColumn; }) &&
            std::all_of(empty, columns.end(), [](auto column) { return column == kEmptyColumn; });
        if (bar)
            return fmt::format("[{} %]",
                               ((empty - columns.begin()) * 100 + 125) / static_cast<long>(columns.size()));
        std::string line;
        for (std::size_t cell = 0; cell < kCells; ++cell)
            line += read_character(&columns[cell * kCellColumns]);
        return line;
    }

    static char read_character(const std::uint8_t* columns) {
        for (char c = kFirstGlyph; c <= kLastGlyph; ++c)
            if (columns[kGlyphColumns] == 0 &&
                std::equal(columns, columns + kGlyphColumns, kFont[c - kFirstGlyph]))
                return c;
        return '\x7f';
    }

    PartContext& context_;
    Alarm settled_;
    std::array<std::array<std::uint8_t, kColumns>, kPages> memory_{};
    std::string shown_ = "off";
    std::size_t page_ = 0, column_ = 0;
    std::uint8_t argument_of_ = 0;
    bool attached_ = true;
    bool on_ = false, flipped_columns_ = true, flipped_rows_ = true;
    bool control_follows_ = false, is_data_ = false, one_byte_ = false;
};

PartPlan read_sh1106(PartReader& reader) {
    return {.claims = {{reader.sda(), PinUse::kBus}, {reader.scl(), PinUse::kBus}},
            .timers = 1,
            .make = maker<Sh1106>(0)};
}

constexpr std::array kSh1106Verbs{PartVerb{"detach", "", "take a chip off its bus"},
                                  PartVerb{"attach", "", "put it back"}};

}  // namespace

const PartKind& sh1106_part() {
    static constexpr PartKind kind{"sh1106", kSh1106Verbs, read_sh1106};
    return kind;
}

}  // namespace asip::sim
