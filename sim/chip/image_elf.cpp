// SPDX-License-Identifier: Apache-2.0
#include <elf.h>
#include <fmt/format.h>

#include <cstring>

#include "sim/chip/image_places.hpp"

namespace asip::sim {
namespace {

constexpr std::uint32_t kDataSpace = 0x800000;  // avr-gcc's linker: RAM here, EEPROM 64 kB further on
constexpr std::uint32_t kEepromSpace = 0x810000;
constexpr std::uint32_t kAfterEeprom = 0x820000;

/// The i-th T of a table at `offset`, if the whole of it lies inside the file.
template <class T>
bool read_at(const std::vector<std::uint8_t>& bytes, std::size_t offset, T& value) {
    if (offset > bytes.size() || sizeof(T) > bytes.size() - offset) return false;
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return true;
}

Expected<void> load_segments(const std::vector<std::uint8_t>& bytes, const Elf32_Ehdr& header, Image& image,
                             const std::string& name) {
    for (unsigned i = 0; i < header.e_phnum; ++i) {
        Elf32_Phdr segment;
        if (!read_at(bytes, header.e_phoff + std::size_t{i} * sizeof segment, segment))
            return fail(name + ": cut off inside its program headers");
        if (segment.p_type != PT_LOAD || segment.p_filesz == 0) continue;
        if (segment.p_offset > bytes.size() || segment.p_filesz > bytes.size() - segment.p_offset)
            return fail(fmt::format("{}: cut off: segment {} lies beyond its end", name, i));
        const auto* data = bytes.data() + segment.p_offset;
        const auto address = segment.p_paddr;
        bool fits = true;
        if (address < kDataSpace)
            fits = place_in_flash(image, address, data, segment.p_filesz);
        else if (address >= kEepromSpace && address < kAfterEeprom)
            fits = place_in_eeprom(image, address - kEepromSpace, data, segment.p_filesz);
        if (!fits) return fail(fmt::format("{}: segment {} at {:#x} fits no AVR", name, i, address));
    }
    return {};
}

void load_symbols(const std::vector<std::uint8_t>& bytes, const Elf32_Shdr& table, const Elf32_Shdr& names,
                  Image& image) {
    for (std::size_t at = 0; at + sizeof(Elf32_Sym) <= table.sh_size; at += sizeof(Elf32_Sym)) {
        Elf32_Sym symbol;
        if (!read_at(bytes, table.sh_offset + at, symbol)) return;
        const auto type = ELF32_ST_TYPE(symbol.st_info);
        if (symbol.st_name == 0 || symbol.st_shndx == SHN_UNDEF || type == STT_FILE || type == STT_SECTION)
            continue;
        const std::size_t start = std::size_t{names.sh_offset} + symbol.st_name;
        if (start >= bytes.size()) continue;
        const auto* text = reinterpret_cast<const char*>(bytes.data() + start);
        const auto length = strnlen(text, bytes.size() - start);
        const auto value = symbol.st_value;
        image.symbols.emplace(std::string(text, length), value >= kDataSpace ? value - kDataSpace : value);
    }
}

}  // namespace

Expected<Image> parse_elf(const std::vector<std::uint8_t>& bytes, const std::string& name) {
    Elf32_Ehdr header;
    if (bytes.size() < EI_NIDENT || std::memcmp(bytes.data(), ELFMAG, SELFMAG) != 0)
        return fail(name + ": not an .elf file");
    if (bytes[EI_CLASS] != ELFCLASS32 || !read_at(bytes, 0, header) || header.e_machine != EM_AVR)
        return fail(name + ": an .elf file, but not for AVR (was it built for this computer?)");

    Image image;
    if (auto loaded = load_segments(bytes, header, image, name); !loaded) return fail(loaded.error());
    if (image.flash.empty())
        return fail(name + ": has no program in it (an object file that was not linked?)");
    for (unsigned i = 0; i < header.e_shnum; ++i) {
        Elf32_Shdr section;
        Elf32_Shdr names;
        if (!read_at(bytes, header.e_shoff + std::size_t{i} * sizeof section, section)) break;
        if (section.sh_type != SHT_SYMTAB) continue;
        if (read_at(bytes, header.e_shoff + std::size_t{section.sh_link} * sizeof names, names))
            load_symbols(bytes, section, names, image);
    }
    return image;
}

}  // namespace asip::sim
