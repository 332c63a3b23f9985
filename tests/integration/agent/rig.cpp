// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/agent/rig.hpp"

#include <csignal>
#include <stdexcept>

#include "tests/support/patterns.hpp"

namespace asip::test {

SimulatedUno::SimulatedUno(const std::string& image) : port_(folder_.file("uno")) {
    const std::string file =
        folder_.write("uno.json", R"({"name":"uno","board":"uno","image":")" ASIP_IMAGES "/" + image +
                                      R"(.elf","link":")" + port_ +
                                      R"(","parts":[{"kind":"wire","name":"wire","from":13,"to":12},
        {"kind":"ultrasonic","name":"distance","trigger":7,"echo":7,"distance":42}]})");
    process_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{ASIP_PROGRAMS "/asip-sim", file, "--no-socket"});
    if (!process_->wait_for_output(" port ")) throw std::runtime_error("asip-sim: " + process_->errors());
}

SimulatedRobot::SimulatedRobot() : port_(folder_.file("robot")) {
    const auto file = folder_.write("robot.json", R"({"name":"robot","board":"uno","image":")" ASIP_IMAGES
                                                  R"(/asip_uno_robot.elf","link":")" +
                                                      port_ +
                                                      R"(","parts":[{"kind":"led","name":"motor","pin":5},
                                        {"kind":"led","name":"direction","pin":7}]})");
    process_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{ASIP_PROGRAMS "/asip-sim", file, "--no-socket"});
    if (!process_->wait_for_output(" port ")) throw std::runtime_error("asip-sim: " + process_->errors());
}

std::vector<Seconds> SimulatedRobot::switched() const {
    std::vector<Seconds> times;
    bool runs = false;
    for (const auto& match : all_matches(process_->output(), "robot ([0-9.]+) motor (.*)")) {
        if ((match[2] != "off" && match[2] != "pwm 0") == runs) continue;
        runs = !runs;
        times.emplace_back(std::stod(match[1]));
    }
    return times;
}

std::vector<std::string> agent_command(const std::string& broker, const std::string& port,
                                       std::vector<std::string> more) {
    std::vector<std::string> command{ASIP_PROGRAMS "/asip-agent",
                                     "--serial",
                                     port,
                                     "--broker",
                                     broker,
                                     "--name",
                                     "uno1",
                                     "--log-level",
                                     "debug"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
}

Agent::Agent(const MosquittoBroker& broker, const std::string& port, std::vector<std::string> more)
    : process_(std::make_unique<ChildProcess>(agent_command(broker.url(), port, std::move(more)))) {}

void Agent::kill() {
    process_->signal(SIGKILL);
    process_->wait_exit();
}

bool wait_state(const BusProbe& probe, const std::string& state, std::chrono::milliseconds limit,
                const std::string& board) {
    return wait_until([&] { return probe.last("asip/servicebus/" + board + "/$state") == state; }, limit);
}

}  // namespace asip::test
