// SPDX-License-Identifier: Apache-2.0
#include "cli/find/profiles.hpp"

#include <algorithm>
#include <fstream>

#include "asip/model/names.hpp"
#include "asip/program/config_file.hpp"
#include "asip/program/kept_file.hpp"
#include "asip/text/nearest.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;

/// The value of an option that was typed; nothing: it was not.
std::optional<std::string> typed_value(const std::vector<std::string>& arguments, const std::string& name) {
    const auto option = "--" + name;
    for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
        if (arguments[i] == option) return i + 1 < arguments.size() ? arguments[i + 1] : std::string();
        if (arguments[i].starts_with(option + "=")) return arguments[i].substr(option.size() + 1);
    }
    return std::nullopt;
}

bool names_a_bus(const std::vector<std::string>& arguments) {
    return typed_value(arguments, "broker") || typed_value(arguments, "credentials") ||
           typed_value(arguments, "config");
}

bool names_a_bus(const Profiles::Variables& variables) {
    for (const auto* name : {"ASIP_BROKER", "ASIP_CREDENTIALS", "ASIP_CONFIG"})
        if (const auto value = variables(name); value && !value->empty()) return true;
    return false;
}

}  // namespace

std::string Profile::value(const std::string& option) const {
    for (const auto& [key, text] : options)
        if (key == option) return text;
    return {};
}

std::optional<Profiles> Profiles::of_user(const Variables& variables) {
    if (const auto folder = variables("XDG_CONFIG_HOME"); folder && !folder->empty())
        return Profiles(fs::path(*folder) / "asip");
    if (const auto home = variables("HOME"); home && !home->empty())
        return Profiles(fs::path(*home) / ".config" / "asip");
    return std::nullopt;
}

std::vector<std::string> Profiles::names() const {
    std::vector<std::string> result;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_ / "contexts", error))
        if (entry.path().extension() == ".conf") result.push_back(entry.path().stem().string());
    std::sort(result.begin(), result.end());
    return result;
}

Expected<Profile> Profiles::find(const std::string& name) const {
    std::error_code error;
    if (!model::valid_name(name) || !fs::exists(file_of(name), error))
        return fail("there is no context \"" + name + "\"" + text::did_you_mean(name, names()) +
                    "; see asipctl context list");
    const auto file = program::read_config_file(file_of(name).string(), "asipctl");
    if (!file) return fail(file.error());
    Profile bus{name, {}};
    for (const auto& line : file->lines)
        bus.options.emplace_back(line.name, line.value);
    return bus;
}

Expected<void> Profiles::add(const Profile& bus) {
    if (!model::valid_name(bus.name))
        return fail("a context is named by 1 to 64 of A-Z a-z 0-9 . _ -, not \"" + bus.name + "\"");
    std::string text = "# Made by asipctl context add.\n";
    for (const auto& [name, value] : bus.options) {
        if (value.find_first_of("\n\r\"") != std::string::npos)
            return fail("--" + name + ": a value with quotes or line ends cannot be kept");
        text.append(name).append(" = \"").append(value).append("\"\n");
    }
    return program::keep_file(file_of(bus.name), text);
}

Expected<void> Profiles::remove(const std::string& name) {
    if (const auto bus = find(name); !bus) return fail(bus.error());
    std::error_code error;
    fs::remove(file_of(name), error);
    if (error) return fail(file_of(name).string() + ": " + error.message());
    return current() == name ? use({}) : Expected<void>();
}

std::string Profiles::current() const {
    std::string name;
    std::ifstream file(current_file());
    std::getline(file, name);
    return model::valid_name(name) ? name : std::string();
}

Expected<void> Profiles::use(const std::string& name) {
    if (!name.empty()) {
        if (const auto bus = find(name); !bus) return fail(bus.error());
        return program::keep_file(current_file(), name + "\n");
    }
    std::error_code error;
    fs::remove(current_file(), error);
    return error ? Expected<void>(fail(current_file().string() + ": " + error.message())) : Expected<void>();
}

Expected<std::vector<std::string>> with_profile(std::vector<std::string> arguments,
                                                const Profiles::Variables& variables) {
    const auto typed = typed_value(arguments, "context");
    if (names_a_bus(arguments)) {
        if (typed)
            return fail("--context names a broker already; leave --broker, --credentials and --config away");
        return arguments;
    }
    if (!typed && names_a_bus(variables)) return arguments;
    const auto buses = Profiles::of_user(variables);
    const auto from_environment = variables("ASIP_CONTEXT").value_or("");
    const bool asked_for = typed || !from_environment.empty();
    const auto name = typed                       ? *typed
                      : !from_environment.empty() ? from_environment
                      : buses                     ? buses->current()
                                                  : "";
    if (name.empty()) return arguments;
    if (!buses) return fail("--context: neither HOME nor XDG_CONFIG_HOME is set");
    const auto bus = buses->find(name);
    if (!bus) {
        // The current one was removed by hand: as if there were none.
        return asked_for ? Expected<std::vector<std::string>>(fail(bus.error())) : arguments;
    }
    std::vector<std::string> all;
    for (const auto& [option, value] : bus->options)
        if (!typed_value(arguments, option)) all.push_back("--" + option + "=" + value);
    all.insert(all.end(), arguments.begin(), arguments.end());
    return all;
}

}  // namespace asip::cli
