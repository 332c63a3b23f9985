// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"

namespace asip::link {

/// A boot loader that avrdude speaks to.
struct BootLoader {
    std::string_view board;   ///< "uno", "nano", "nano-old" (a Nano as it was sold until 2018), "mega"; or
                              ///< empty
    std::string_view image;   ///< whose firmware an agent loads into it: "uno", "mega"; or empty
    std::string_view chip;    ///< as the board answers it: "ATmega328P"
    std::string_view part;    ///< as avrdude calls the chip
    std::string_view method;  ///< as avrdude calls the programmer
    std::string_view baud;
};

/// The chip's; nothing: none is known.
std::optional<BootLoader> boot_loader_of_chip(std::string_view chip);

/// The likeliest first. `board`: one of them; empty: by the USB numbers of its port, which may be empty, too.
/// Fails where avrdude can do nothing.
Expected<std::vector<BootLoader>> boot_loaders(std::string_view board, std::string_view vendor,
                                               std::string_view product);

/// `format`: `i` of a .hex file, `e` of an .elf file.
std::vector<std::string> avrdude_call(const BootLoader& loader, const std::string& avrdude,
                                      const std::string& port, const std::string& image, char format = 'i');

/// Reads what avrdude prints.
class AvrdudeOutput {
  public:
    void take(std::string_view bytes);

    /// "connecting", "writing" or "verifying", and how much of that is done.
    std::string_view step() const;
    int percent() const { return percent_; }

    /// No boot loader answered, or that of another chip.
    bool may_be_another() const { return !started_ && (no_answer_ || wrong_chip_); }
    /// For a person, with what to do.
    std::string failure(int status, std::string_view port, const std::string& avrdude) const;

  private:
    void end_line();

    std::string line_;
    std::string last_;  // that said something
    bool started_ = false;
    bool verifies_ = false;
    int percent_ = 0;
    bool no_answer_ = false, wrong_chip_ = false, busy_ = false, denied_ = false, differs_ = false;
};

}  // namespace asip::link
