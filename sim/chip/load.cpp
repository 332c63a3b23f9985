// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/load.hpp"

#include <cstring>

#include "sim/chip/image.hpp"
#include "sim/chip/image_chip.hpp"
#include "sim/chip/simavr.hpp"

namespace asip::sim {

Expected<void> load_into(Board& board, const std::filesystem::path& file) {
    const auto image = load_image(file);
    if (!image) return fail(image.error());
    auto& avr = *board.raw();
    const std::size_t size = avr.flashend + std::size_t{1};
    if (auto fits = check_chip(*image, board.kind(), size); !fits)
        return fail(file.string() + ": " + fits.error());
    std::memset(avr.flash, 0xff, size);
    std::memcpy(avr.flash, image->flash.data(), image->flash.size());
    avr.codeend = static_cast<std::uint32_t>(image->flash.size());
    if (!image->eeprom.empty()) board.set_eeprom(0, image->eeprom);
    board.reset();
    return {};
}

}  // namespace asip::sim
