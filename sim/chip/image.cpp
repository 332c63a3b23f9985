// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/image.hpp"

#include "sim/chip/image_places.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace asip::sim {
namespace {

constexpr std::size_t kLargestFlash = 1 << 20;
constexpr std::size_t kLargestEeprom = 1 << 16;
// Ten times what an image of the largest chip has with all that a debugger needs.
constexpr std::size_t kLargestFile = std::size_t{64} << 20;

std::vector<std::uint8_t> read_at_most(std::istream& stream, std::size_t limit) {
    std::vector<std::uint8_t> bytes;
    std::array<char, 65536> block;
    while (bytes.size() <= limit && (stream.read(block.data(), block.size()) || stream.gcount() > 0))
        bytes.insert(bytes.end(), block.data(), block.data() + stream.gcount());
    return bytes;
}

}  // namespace

Expected<Image> load_image(const std::filesystem::path& file) {
    const auto name = file.string();
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) return fail(name + ": is a folder, not a firmware image");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return fail(name + ": cannot read the firmware image: " + std::strerror(errno));
    const auto bytes = read_at_most(stream, kLargestFile);
    if (bytes.size() > kLargestFile) return fail(name + ": too large for a firmware image");
    if (bytes.empty()) return fail(name + ": the firmware image is empty");
    if (bytes[0] == 0x7f) return parse_elf(bytes, name);
    if (bytes[0] == ':') return parse_hex(bytes, name);
    return fail(name + ": neither an .elf nor an Intel .hex file");
}

/// Places `data` at `address` of a memory that grows as needed; false if it would leave the largest chip.
bool place(std::vector<std::uint8_t>& memory, std::size_t limit, std::size_t address,
           const std::uint8_t* data, std::size_t size) {
    if (address > limit || size > limit - address) return false;
    if (memory.size() < address + size) memory.resize(address + size, 0xff);
    std::copy(data, data + size, memory.begin() + static_cast<std::ptrdiff_t>(address));
    return true;
}

bool place_in_flash(Image& image, std::size_t address, const std::uint8_t* data, std::size_t size) {
    return place(image.flash, kLargestFlash, address, data, size);
}

bool place_in_eeprom(Image& image, std::size_t address, const std::uint8_t* data, std::size_t size) {
    return place(image.eeprom, kLargestEeprom, address, data, size);
}

}  // namespace asip::sim
