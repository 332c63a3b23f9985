// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/load.hpp"

#include <fmt/format.h>

#include <cstring>

#include "sim/chip/image.hpp"
#include "sim/chip/simavr.hpp"

namespace asip::sim {

Expected<void> load_into(Board& board, const std::filesystem::path& file) {
    const auto image = load_image(file);
    if (!image) return fail(image.error());
    auto& avr = *board.raw();
    const std::size_t size = avr.flashend + std::size_t{1};
    if (image->flash.size() > size)
        return fail(fmt::format("{}: the image has {} bytes, the {} of the {} only {}", file.string(),
                                image->flash.size(), board.kind().chip, board.kind().name, size));
    std::memset(avr.flash, 0xff, size);
    std::memcpy(avr.flash, image->flash.data(), image->flash.size());
    avr.codeend = static_cast<std::uint32_t>(image->flash.size());
    if (!image->eeprom.empty()) board.set_eeprom(0, image->eeprom);
    board.reset();
    return {};
}

}  // namespace asip::sim
