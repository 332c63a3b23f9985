// SPDX-License-Identifier: Apache-2.0
#include "asip/program/config_file.hpp"

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

#include "asip/text/file_text.hpp"

namespace asip::program {
namespace {

constexpr std::size_t kMaxConfigBytes = 1u << 20;

Expected<ConfigLine> parse_line(int number, const std::string& line) {
    const auto equals = line.find('=');
    if (equals == std::string::npos) return fail("expected NAME = VALUE");
    auto value = trimmed(std::string_view(line).substr(equals + 1));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
        value = value.substr(1, value.size() - 2);
    auto name = trimmed(std::string_view(line).substr(0, equals));
    std::replace(name.begin(), name.end(), '_', '-');
    return ConfigLine{number, std::move(name), std::move(value)};
}

Expected<std::string> whole_text(const std::string& path) {
    std::ifstream file(path);
    std::string text(kMaxConfigBytes + 1, '\0');
    if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
    // A folder can be opened, too.
    if (!file.is_open() || file.bad()) return fail("cannot read the configuration file " + path);
    if (file.gcount() > static_cast<std::streamsize>(kMaxConfigBytes))
        return fail(path + " is too long for a configuration file");
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text::is_utf16(text)) return fail(path + " is in UTF-16: save it as UTF-8");
    return std::string(text::without_mark(text));
}

enum class Part { kOurs, kOthers, kSection };

struct SectionStart {
    std::string name;
    std::optional<std::string> title;  // of one of the kind that is looked for
};

Expected<SectionStart> parse_section(const std::string& text, std::string_view kind) {
    const auto blank = text.find_first_of(" \t");
    SectionStart start{text.substr(0, blank), std::nullopt};
    if (kind.empty()) return SectionStart{text, std::nullopt};
    if (start.name == kind) {
        start.title =
            blank == std::string::npos ? std::string() : trimmed(std::string_view(text).substr(blank));
    } else if (!text.starts_with("asip") || blank != std::string::npos) {
        return fail("there is no section [" + text + "]: sections are [" + std::string(kind) +
                    " NAME], and those of programs, such as [asip-agent]");
    }
    return start;
}

}  // namespace

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

Expected<ConfigFile> read_config_file(const std::string& path, std::string_view program,
                                      std::string_view kind) {
    const auto text = whole_text(path);
    if (!text) return fail(text.error());
    std::istringstream file(*text);
    ConfigFile read;
    auto part = Part::kOurs;
    int number = 0;
    for (std::string raw; std::getline(file, raw);) {
        ++number;
        const auto line = trimmed(raw);
        const auto where = path + ":" + std::to_string(number) + ": ";
        if (line.empty() || line.front() == '#' || line.front() == ';') continue;
        if (line.front() == '[') {
            if (line.back() != ']') return fail(where + "the ] is missing");
            auto section = parse_section(trimmed(std::string_view(line).substr(1, line.size() - 2)), kind);
            if (!section) return fail(where + section.error());
            part = section->title ? Part::kSection : section->name == program ? Part::kOurs : Part::kOthers;
            if (section->title) read.sections.push_back({number, *section->title, {}});
            continue;
        }
        if (part == Part::kOthers) continue;
        auto parsed = parse_line(number, line);
        if (!parsed) return fail(where + parsed.error());
        (part == Part::kOurs ? read.lines : read.sections.back().lines).push_back(std::move(*parsed));
    }
    return read;
}

}  // namespace asip::program
