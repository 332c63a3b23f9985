// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/truth/live/line_proxy.hpp"

namespace truth {

constexpr int kPins[] = {3, 5, 6, 9, 10, 11};

/// A simulated board (an Uno or a Pico) with an LED at each PWM pin, its damaged line, and the agent that
/// brings it onto the bus.
class LiveBoard {
  public:
    /// `pico`: the script that runs it; empty: an Uno in asip-sim.
    LiveBoard(std::string name, const std::string& pico, const std::string& image, bool checksums,
              const std::string& broker_url, std::uint64_t seed);

    const std::string& name() const { return name_; }
    bool has_checksums() const { return checksums_; }
    std::uint16_t client_port() const { return client_port_; }
    LineProxy& line() { return *line_; }
    void reset() { simulator_->write_input("reset\n"); }
    void start_agent();
    asip::test::ChildProcess& agent() { return *agent_; }

    /// Reads what the simulator has reported since.
    void observe();
    /// When the pin was set to that duty, by the clock of now_ms(); 0: never.
    std::int64_t executed_at(int pin, int duty) const;

  private:
    std::string name_;
    bool checksums_;
    std::string broker_url_;
    asip::test::TempDir folder_;
    std::uint16_t client_port_;
    std::unique_ptr<asip::test::ChildProcess> simulator_;
    std::unique_ptr<LineProxy> line_;
    std::unique_ptr<asip::test::ChildProcess> agent_;
    std::size_t read_ = 0;
    std::map<std::pair<int, int>, std::int64_t> executed_;
};

}  // namespace truth
