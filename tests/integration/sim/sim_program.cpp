// SPDX-License-Identifier: Apache-2.0
#include "sim_program.hpp"

#include <csignal>
#include <stdexcept>

#include "tests/support/patterns.hpp"

namespace asip::test {
namespace {

[[maybe_unused]] const bool replaced = replace_simulator();

std::vector<std::string> command_line(std::vector<std::string> arguments, const std::string& socket) {
    arguments.insert(arguments.begin(), ASIP_SIM);
    arguments.insert(arguments.end(), {"--socket", socket});
    return arguments;
}

}  // namespace

SimProgram::SimProgram(const TempDir& folder, std::vector<std::string> arguments, int boards)
    : socket_(folder.file("control.sock")), process_(command_line(std::move(arguments), socket_)) {
    const bool named = wait_until([&] {
        const auto output = process_.output();
        const auto ports = all_matches(output, R"(\bport path=(\S+)|"event":"port","path":"([^"]+)\")");
        if (std::ssize(ports) < boards) return false;
        port_ = ports.at(0).at(1) + ports.at(0).at(2);  // one of them is there
        if (const auto tcp = first_match(output, "tcp=([0-9]+)")) tcp_port_ = std::stoi(tcp->at(1));
        return control({"help"}).status == 0;  // a socket file may be one that a crash left
    });
    if (!named) throw std::runtime_error("asip-sim does not start: " + process_.errors());
}

Finished SimProgram::control(std::vector<std::string> words) {
    words.insert(words.begin(), {ASIP_SIM, "ctl", "--socket", socket_});
    return run(words);
}

std::optional<int> SimProgram::terminate() {
    process_.signal(SIGTERM);
    return process_.wait_exit();
}

std::string board_file(const TempDir& folder, const std::string& name, const std::string& more) {
    return folder.write(name, R"({"image": ")" MONITOR_IMAGE "\"" + more + "}");
}

}  // namespace asip::test
