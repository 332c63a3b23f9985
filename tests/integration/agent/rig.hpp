// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/bus_probe.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {

/// A simulated Uno: real firmware, its port at port(). Parts: `wire` from pin 13 to pin 12, `distance` on pin
/// 7, `servo`.
class SimulatedUno {
  public:
    explicit SimulatedUno(const std::string& image = "asip_uno_services");

    const std::string& port() const { return port_; }
    void command(const std::string& line) { process_->write_input(line + "\n"); }
    ChildProcess& process() { return *process_; }

  private:
    TempDir folder_;
    std::string port_;
    std::unique_ptr<ChildProcess> process_;
};

using Seconds = std::chrono::duration<double>;

/// The robot's firmware in a simulated Uno, called `robot`. A lamp listens on the PWM pin of motor 0.
class SimulatedRobot {
  public:
    SimulatedRobot();

    const std::string& port() const { return port_; }
    void command(const std::string& line) { process_->write_input(line + "\n"); }

    /// Simulated times at which the motor began or ended to run, in turn.
    std::vector<Seconds> switched() const;
    bool runs() const { return switched().size() % 2 == 1; }

  private:
    TempDir folder_;
    std::string port_;
    std::unique_ptr<ChildProcess> process_;
};

/// asip-agent as a child process.
class Agent {
  public:
    Agent(const MosquittoBroker& broker, const std::string& port, std::vector<std::string> more = {});
    ChildProcess& process() { return *process_; }
    void kill();

  private:
    std::unique_ptr<ChildProcess> process_;
};

std::vector<std::string> agent_command(const std::string& broker, const std::string& port,
                                       std::vector<std::string> more = {});

/// Until `asip/servicebus/BOARD/$state` says `state`.
bool wait_state(const BusProbe& probe, const std::string& state, std::chrono::milliseconds limit = kDeadline,
                const std::string& board = "uno1");

}  // namespace asip::test
