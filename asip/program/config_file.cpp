// SPDX-License-Identifier: Apache-2.0
#include "asip/program/config_file.hpp"

#include <algorithm>
#include <fstream>

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

}  // namespace

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

Expected<std::vector<ConfigLine>> read_config_file(const std::string& path, std::string_view program) {
    std::ifstream file(path);
    if (!file) return fail("cannot read the configuration file " + path);
    std::vector<ConfigLine> lines;
    bool ours = true;
    int number = 0;
    std::size_t bytes = 0;
    for (std::string raw; std::getline(file, raw);) {
        ++number;
        if ((bytes += raw.size() + 1) > kMaxConfigBytes)
            return fail(path + " is too long for a configuration file");
        const auto line = trimmed(raw);
        const auto where = path + ":" + std::to_string(number) + ": ";
        if (line.empty() || line.front() == '#' || line.front() == ';') continue;
        if (line.front() == '[') {
            if (line.back() != ']') return fail(where + "the ] is missing");
            ours = trimmed(std::string_view(line).substr(1, line.size() - 2)) == program;
            continue;
        }
        if (!ours) continue;
        auto parsed = parse_line(number, line);
        if (!parsed) return fail(where + parsed.error());
        lines.push_back(std::move(*parsed));
    }
    return lines;
}

}  // namespace asip::program
