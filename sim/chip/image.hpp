// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::sim {

struct Image {
    std::vector<std::uint8_t> flash;   ///< from address 0; gaps are 0xff, as in an erased flash
    std::vector<std::uint8_t> eeprom;  ///< what the image brings along, from address 0
    /// Without the linker's 0x800000.
    std::map<std::string, std::uint32_t, std::less<>> symbols;
};

/// AVR .elf or Intel .hex, by content. The error names the file, and for a .hex the line.
Expected<Image> load_image(const std::filesystem::path& file);

/// From memory; `name`: for errors.
Expected<Image> parse_elf(const std::vector<std::uint8_t>& bytes, const std::string& name);
Expected<Image> parse_hex(const std::vector<std::uint8_t>& bytes, const std::string& name);

}  // namespace asip::sim
