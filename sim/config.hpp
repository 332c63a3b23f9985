#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace asip::sim {

// What can be wired to a board. Pins are Arduino pin numbers (A0 of an Uno is 14).

/// An LED to ground (lit by a high pin), or to VCC with `active_low`.
struct LedSpec {
    int pin = 0;
    bool active_low = false;
};

/// A push button to ground, open when released (the sketch uses a pull-up); with `to_vcc` it connects to VCC
/// and has a pull-down of its own.
struct ButtonSpec {
    int pin = 0;
    bool to_vcc = false;
};

/// A wire between two pins: whichever is an output drives the other.
struct WireSpec {
    int from = 0;
    int to = 0;
};

/// A potentiometer between ground and VCC on an analog pin.
struct PotentiometerSpec {
    int pin = 0;
    double position = 0.5;  ///< 0 = ground, 1 = VCC
};

/// An ultrasonic distance sensor. With `echo` equal to `trigger` it is the one-pin kind that ASIP's Distance
/// service uses: the echo comes back on the pin that triggered it.
struct UltrasonicSpec {
    int trigger = 0;
    int echo = 0;
    double distance_cm = 100;  ///< above 400 (or below 0): no echo, as when nothing is in range
};

/// A hobby servo; its angle is what its pulses ask for (544 us = 0, 2400 us = 180 degrees).
struct ServoSpec {
    int pin = 0;
};

/// A square-wave generator that drives a pin. 0 Hz is a steady low.
struct SquareWaveSpec {
    int pin = 0;
    double hertz = 1;
};

using PartSpec =
    std::variant<LedSpec, ButtonSpec, WireSpec, PotentiometerSpec, UltrasonicSpec, ServoSpec, SquareWaveSpec>;

struct PartConfig {
    std::string name;  ///< unique on the board; what commands and printed changes call it
    PartSpec spec;
};

/// A board: image, chip, parts. Built in code by tests, read from a JSON file by asip-sim.
struct BoardConfig {
    std::string name = "board";
    std::string board = "uno";    ///< "uno", "mega", "leonardo"
    std::filesystem::path image;  ///< .elf or Intel .hex
    std::vector<PartConfig> parts;

    std::filesystem::path eeprom;  ///< kept in this file from run to run; empty: starts erased every time
    std::uint32_t frequency = 16'000'000;
    char uart = 0;  ///< '0'..'3'; 0: the board's usual one

    /// Rate of the host's side of the line. 0 follows the board, whatever rate it sets (bytes are always
    /// understood). Otherwise bytes are garbled both ways while the board's rate is more than 3 % away, as
    /// they are on a real line.
    std::uint32_t host_baud = 0;
};

}  // namespace asip::sim
