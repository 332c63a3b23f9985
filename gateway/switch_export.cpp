// SPDX-License-Identifier: Apache-2.0
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "asip/program/exit_status.hpp"
#include "asip/text/printable.hpp"
#include "gateway/application.hpp"
#include "gateway/replaced_file.hpp"

namespace asip::gateway {
namespace {

constexpr const char* kServiceUnit = "asip-gateway";

int refuse_switch(const std::string& text) {
    std::cerr << "asip-gateway: " << text << "\n";
    return program::kExitUsage;
}

/// As the options are called in the environment: ASIP_HOME_ASSISTANT.
std::string variable_of(const std::string& system) {
    std::string name = "ASIP_" + system;
    for (char& c : name)
        c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return name;
}

/// The other lines of the file, and `line` behind them.
std::string with_line(const std::string& text, const std::string& variable, const std::string& line) {
    std::istringstream lines(text);
    std::string result;
    for (std::string each; std::getline(lines, each);)
        if (!each.starts_with(variable + "=")) result += each + "\n";
    return result + line;
}

/// Where the service runs it begins with what the file says now.
bool restart_service() {
    const char* arguments[] = {"systemctl", "try-restart", kServiceUnit, nullptr};
    pid_t pid = 0;
    if (posix_spawnp(&pid, arguments[0], nullptr, nullptr, const_cast<char**>(arguments), environ) != 0)
        return false;
    int status = 0;
    while (waitpid(pid, &status, 0) < 0)
        if (errno != EINTR) return false;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// The gateway says what is wrong with a value, and would not start with it.
bool starts_with_it(const std::string& system, const std::string& value) {
    const auto option = "--" + system + "=" + value;
    const char* const line[] = {kServiceUnit, option.c_str()};
    return read_options(2, line).has_value();
}

}  // namespace

int switch_export(const ExportSwitch& request) {
    auto value = request.value;
    if (value.empty()) value = request.system == "home-assistant" ? "homeassistant" : request.system;
    if (!request.off) {
        if (request.system == "sparkplug" && request.value.empty())
            return refuse_switch("name the group: asip-gateway export sparkplug GROUP[/EDGE]");
        if (value.find_first_of(" \t\r\n\"'\\$#") != std::string::npos)
            return refuse_switch("\"" + text::printable(value) + "\" has a character that " + request.file +
                                 " cannot carry");
        if (!starts_with_it(request.system, value)) return program::kExitUsage;
    }
    std::ifstream file(request.file);
    std::ostringstream text;
    if (file) text << file.rdbuf();
    std::error_code error;
    if (!file && std::filesystem::exists(request.file, error))
        return refuse_switch("cannot read " + request.file + ": only root may");
    const auto variable = variable_of(request.system);
    const auto line = request.off ? std::string() : variable + "=" + value + "\n";
    const auto result = with_line(text.str(), variable, line);
    if (!replace_file(request.file, result))
        return refuse_switch("cannot write " + request.file + ": " + std::strerror(errno));
    std::cout << request.file << ": " << (request.off ? variable + " is gone" : variable + "=" + value)
              << "\n";
    if (request.file != ExportSwitch::kFile || !restart_service())
        std::cout << "The gateway does so from its next start on\n";
    return program::kExitOk;
}

}  // namespace asip::gateway
