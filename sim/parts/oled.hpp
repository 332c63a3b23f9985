// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "sim/wiring/part_context.hpp"
#include "sim/wiring/part_reader.hpp"

namespace asip::sim {

/// What the controllers of such displays differ in.
struct OledController {
    std::size_t columns;      ///< of its memory
    std::size_t first_shown;  ///< of these, on the usual glass
    bool addressing_modes;    ///< it steps from page to page by itself, where it was told to
};

/// A display of 128 x 64 pixels on the I2C bus. It reads what it shows: text in the font of this project's
/// firmware, and bars; all of it can be had as a picture.
class Oled final : public Part, public I2cDevice {
  public:
    Oled(std::string name, const PartKind& kind, OledController controller, PartContext& context);

    /// The lines that are not empty: `0:Hello 3:[50 %]`; "off" and "upside down" for a display that is.
    std::string state() const override { return attached_ ? shown_ : "detached"; }

    std::uint8_t address() const override;
    bool is_there() const override { return attached_; }
    void started(bool reading) override {
        if (!reading) control_follows_ = true;
    }
    std::uint8_t read() override { return on_ ? 0 : 0x40; }
    bool write(std::uint8_t byte) override;

    static constexpr std::array kVerbs{PartVerb{"detach", "", "take a chip off its bus"},
                                       PartVerb{"attach", "", "put it back"},
                                       PartVerb{"picture", "FILE", "what a display shows, as PBM"}};
    static PartPlan read_plan(PartReader& reader, decltype(PartPlan::make) make);

  private:
    Expected<void> perform(std::string_view verb, std::string_view argument) override;
    Expected<void> draw(const std::string& file) const;
    void power_on();
    void write_data(std::uint8_t byte);
    void command(std::uint8_t byte);
    void argument(std::uint8_t byte);
    void look();
    bool pixel(std::size_t x, std::size_t y) const;
    std::uint8_t rows(std::size_t x, std::size_t y) const;
    std::string text() const;
    std::string read_line(std::size_t y) const;

    static constexpr std::size_t kPages = 8;
    struct Window {
        std::size_t first, last;
    };

    PartContext& context_;
    OledController controller_;
    Alarm settled_;
    std::array<std::array<std::uint8_t, 132>, kPages> memory_{};
    std::string shown_ = "off";
    std::size_t page_ = 0, column_ = 0;
    Window columns_{0, 127}, pages_{0, 7};  // of the modes that step by themselves
    std::uint8_t mode_ = 2;                 // 0 row by row, 1 column by column, 2 within a page
    std::uint8_t argument_of_ = 0;
    std::size_t arguments_left_ = 0;
    bool attached_ = true;
    bool on_ = false, flipped_columns_ = true, flipped_rows_ = true;
    bool control_follows_ = false, is_data_ = false, one_byte_ = false;
};

}  // namespace asip::sim
