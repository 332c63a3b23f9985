// SPDX-License-Identifier: Apache-2.0
#include "cli/find/user_file.hpp"

#include <algorithm>
#include <string_view>

#include "asip/program/config_file.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

bool is_typed(const std::vector<std::string>& arguments, std::string_view name) {
    const auto option = "--" + std::string(name);
    const auto end = std::find(arguments.begin(), arguments.end(), "--");
    return std::any_of(arguments.begin(), end, [&](const std::string& word) {
        return word == option || word.starts_with(option + "=");
    });
}

bool names_a_bus(const std::vector<std::string>& arguments, const Variables& variables) {
    for (const auto* name : {"broker", "credentials", "config"})
        if (is_typed(arguments, name)) return true;
    for (const auto* name : {"ASIP_BROKER", "ASIP_CREDENTIALS", "ASIP_CONFIG"})
        if (!variables(name).value_or("").empty()) return true;
    return false;
}

}  // namespace

std::optional<fs::path> user_file(const Variables& variables) {
    const fs::path file = "asip/asipctl.conf";
    if (const auto folder = variables("XDG_CONFIG_HOME").value_or(""); !folder.empty()) return folder / file;
    if (const auto home = variables("HOME").value_or(""); !home.empty()) return home / (".config" / file);
    return std::nullopt;
}

Expected<std::vector<std::string>> with_user_file(std::vector<std::string> arguments,
                                                  const Variables& variables) {
    const auto path = user_file(variables);
    std::error_code error;
    if (!path || names_a_bus(arguments, variables) || !fs::exists(*path, error)) return arguments;
    const auto file = program::read_config_file(path->string(), "asipctl");
    if (!file) return fail(file.error());
    std::vector<std::string> all;
    for (const auto& line : file->lines)
        if (!is_typed(arguments, line.name)) all.push_back("--" + line.name + "=" + line.value);
    all.insert(all.end(), arguments.begin(), arguments.end());
    return all;
}

}  // namespace asip::cli
