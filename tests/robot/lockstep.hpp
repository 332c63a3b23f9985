// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <ostream>
#include <string>
#include <vector>

#include "examples/line_controller.hpp"
#include "sim/world/world.hpp"

namespace asip::test {

/// What is between the line follower and the board's serial port, each way.
struct Path {
    std::string name = "serial";
    std::chrono::microseconds latency{0};  ///< of each message
    std::chrono::microseconds jitter{0};   ///< up to this much more, evenly; messages keep their order
    double loss = 0;                       ///< share of the messages that never arrive
};
inline void PrintTo(const Path& path, std::ostream* out) {
    *out << path.name;
}

/// The follower opens the serial port itself.
Path serial_path();
/// Through an agent's TCP server on one machine, and over MQTT through agent and broker: more than both took
/// on a busy machine of two cores (bench/run_all agent).
Path tcp_path();
Path mqtt_path();

struct Drive {
    Path path = serial_path();
    LineGains gains{};
    std::chrono::milliseconds period{50};  ///< of the reports; each is answered by one command
    unsigned laps = 2;
    std::chrono::seconds limit{60};  ///< of simulated time
    unsigned seed = 1;
};

struct Driven {
    bool stayed = true;  ///< never left the line
    std::vector<sim::world::Lap> laps;
    std::chrono::nanoseconds took{0};
    unsigned reports = 0;
    unsigned commands = 0;  ///< that the board has executed
    unsigned unproven = 0;  ///< commands that ended in any other way

    bool ok(unsigned wanted) const { return stayed && laps.size() >= wanted; }
    /// Means over the laps but the first, which begins at rest (over all where there is only one).
    double lap_seconds() const { return mean(&sim::world::Lap::seconds); }
    double rms_mm() const { return mean(&sim::world::Lap::rms_mm); }

  private:
    double mean(double sim::world::Lap::* value) const;
};

/// The whole loop in one process and in simulated time: the world, an Uno with the image of AsipMirto, the
/// session as an agent runs it, the path, the line follower. The same each time. Ends when the laps are
/// driven, when the rover leaves the line, or at the limit. Throws std::runtime_error if the board cannot be
/// simulated or does not answer.
Driven drive(const Drive& how, const std::string& image, const std::string& world_file);

}  // namespace asip::test
