// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/live/live_board.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

#include "tests/support/temp_dir.hpp"

namespace truth {

namespace test = asip::test;

LiveBoard::LiveBoard(std::string name, const std::string& pico, const std::string& image, bool checksums,
                     const std::string& broker_url, std::uint64_t seed)
    : name_(std::move(name)),
      checksums_(checksums),
      broker_url_(broker_url),
      client_port_(test::free_port()) {
    const auto board_port = test::free_port();
    std::string parts;
    for (const int pin : kPins)
        parts +=
            fmt::format(R"({}{{"kind":"led","name":"p{}","pin":{}}})", parts.empty() ? "" : ",", pin, pin);
    const auto board = fmt::format(R"({{"image":"{}/{}.elf","tcp":{},"parts":[{}]}})", ASIP_IMAGES, image,
                                   board_port, parts);
    simulator_ = std::make_unique<test::ChildProcess>(
        pico.empty() ? std::vector<std::string>{ASIP_PROGRAMS "/asip-sim", folder_.write("board.json", board),
                                                "--no-socket", "--json"}
                     : std::vector<std::string>{"node", pico, board});
    if (!simulator_->wait_for_output("tcp")) throw std::runtime_error("simulator: " + simulator_->errors());
    line_ = std::make_unique<LineProxy>(folder_.file("line"), board_port, seed);
    start_agent();
}

void LiveBoard::start_agent() {
    std::vector<std::string> command{ASIP_PROGRAMS "/asip-agent",
                                     "--serial",
                                     folder_.file("line"),
                                     "--broker",
                                     broker_url_,
                                     "--name",
                                     name_,
                                     "--takeover",
                                     "--patience",
                                     "60",
                                     "--listen",
                                     std::to_string(client_port_)};
    if (checksums_)
        command.insert(command.end(), {"--config", asip::test::settings_file("checksum = true\n")});
    agent_ = std::make_unique<test::ChildProcess>(std::move(command));
}

void LiveBoard::observe() {
    const std::string output = simulator_->output();
    const auto now = now_ms();
    for (auto end = output.find('\n', read_); end != std::string::npos; end = output.find('\n', read_)) {
        const std::string line = output.substr(read_, end - read_);
        read_ = end + 1;
        int pin = 0, duty = 0;
        const auto part = line.find(R"("part":"p)");
        const auto value = line.find(R"("value":"pwm )");
        if (part == std::string::npos || value == std::string::npos) continue;
        if (std::sscanf(line.c_str() + part, R"("part":"p%d)", &pin) != 1) continue;
        if (std::sscanf(line.c_str() + value, R"("value":"pwm %d)", &duty) != 1) continue;
        executed_.try_emplace({pin, duty}, now);
    }
}

std::int64_t LiveBoard::executed_at(int pin, int duty) const {
    const auto known = executed_.find({pin, duty});
    return known == executed_.end() ? 0 : known->second;
}

}  // namespace truth
