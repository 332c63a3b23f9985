// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/image_chip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace asip::sim {
namespace {

struct Vectors {
    std::size_t count;
    std::string_view chips;
};
constexpr std::array kKnown{
    Vectors{26, "atmega328p, atmega168"},
    Vectors{31, "atmega644p"},
    Vectors{35, "atmega1284p"},
    Vectors{43, "atmega32u4"},
    Vectors{57, "atmega2560, atmega1280"},
};

/// The jumps at its beginning.
std::size_t count_vectors(const Image& image) {
    std::size_t count = 0;
    for (std::size_t at = 0; at + 3 < image.flash.size(); at += 4, ++count)
        if ((image.flash[at] & 0xfe) != 0x0c || image.flash[at + 1] != 0x94) break;
    return count;
}

}  // namespace

Expected<void> check_chip(const Image& image, const BoardKind& kind, std::size_t flash_bytes) {
    if (image.flash.size() > flash_bytes)
        return fail(fmt::format("the image has {} bytes, the {} of the {} only {}", image.flash.size(),
                                kind.chip, kind.name, flash_bytes));
    const auto found =
        std::find_if(kKnown.begin(), kKnown.end(),
                     [count = count_vectors(image)](const Vectors& known) { return known.count == count; });
    if (found != kKnown.end() && found->chips.find(kind.chip) == std::string_view::npos)
        return fail(fmt::format("an image for another chip ({}); the {} has an {}", found->chips, kind.name,
                                kind.chip));
    return {};
}

}  // namespace asip::sim
