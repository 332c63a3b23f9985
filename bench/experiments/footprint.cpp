// SPDX-License-Identifier: Apache-2.0
// RAM and flash that the firmware takes on an Uno, as the linker placed it.
#include <array>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "bench/experiments/experiment.hpp"
#include "bench/experiments/recorded.hpp"

namespace asip::experiments {
namespace {

struct Size {
    long ram = 0, flash = 0;
};

Size size_of(const std::string& image) {
    std::string quoted;
    for (const char c : image)
        quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    const auto command = "avr-size -B '" + quoted + "' 2>&1";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    std::array<char, 512> line{};
    long text = 0, data = 0, bss = 0;
    if (!pipe || !std::fgets(line.data(), line.size(), pipe.get()) ||
        !std::fgets(line.data(), line.size(), pipe.get()) ||
        std::sscanf(line.data(), "%ld %ld %ld", &text, &data, &bss) != 3)
        throw std::runtime_error("avr-size finds no sections in " + image +
                                 ": give an .elf file of an AVR board");
    return {data + bss, text + data};
}

struct Sketch {
    const char* name;
    const char* image;
};
constexpr Sketch kSketches[] = {
    {"ours: I/O service (AsipHello)", ASIP_IMAGES "/asip_uno.elf"},
    {"the same without our extensions", ASIP_IMAGES "/asip_uno_04.elf"},
    {"ours: I/O, distance, servos (AsipServices)", ASIP_IMAGES "/asip_uno_services.elf"},
    {"ours: the robot, seven services (AsipMirto)", ASIP_IMAGES "/asip_uno_mirto.elf"},
};

}  // namespace

std::vector<Results> footprint(const Setup& setup) {
    Results results{
        .name = "footprint",
        .title = "Memory of an Uno (of 2,048 bytes of RAM and 32,256 of flash)",
        .columns = {"firmware", "RAM, B", "flash, B", "source"},
        .rows = {},
        .notes =
            {"static RAM (.data and .bss) and flash (.text and .data), by avr-size; the stack is not in it",
             kWhereFrom, kNotRecorded},
        .pictures = {}};
    Bars ram{"Static RAM of an Uno, bytes", {}}, flash{"Flash of an Uno, bytes", {}};
    const auto add = [&](const std::string& name, const Size& size, const std::string& source) {
        results.rows.push_back({name, std::to_string(size.ram), std::to_string(size.flash), source});
        ram.bars.emplace_back(name, size.ram);
        flash.bars.emplace_back(name, size.flash);
    };
    for (const auto& sketch : kSketches)
        add(sketch.name, size_of(sketch.image), "measured");
    if (!setup.other_image.empty()) add(setup.other_image, size_of(setup.other_image), "measured");
    for (const auto& peer : kPeers)
        add(std::string(peer.name) + ": I/O service", {peer.ram_bytes, peer.flash_bytes}, "recorded");
    add(kEmptySketch.name, {kEmptySketch.ram_bytes, kEmptySketch.flash_bytes}, "recorded");
    results.pictures = {{"ram", ram.svg()}, {"flash", flash.svg()}};
    return {results};
}

}  // namespace asip::experiments
