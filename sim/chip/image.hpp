// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::sim {

/// A firmware image as it goes into a chip.
struct Image {
    std::vector<std::uint8_t> flash;   ///< from address 0; gaps are 0xff, as in an erased flash
    std::vector<std::uint8_t> eeprom;  ///< what the image brings along, from address 0
    /// Data addresses without the linker's 0x800000.
    std::map<std::string, std::uint32_t, std::less<>> symbols;
};

/// Reads an AVR .elf or an Intel .hex file, recognised by content. The error names the file, and for a .hex
/// the line.
Expected<Image> load_image(const std::filesystem::path& file);

/// The two formats from memory; `name` is for the errors.
Expected<Image> parse_elf(const std::vector<std::uint8_t>& bytes, const std::string& name);
Expected<Image> parse_hex(const std::vector<std::uint8_t>& bytes, const std::string& name);

}  // namespace asip::sim
