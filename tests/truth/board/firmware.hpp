// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace truth {

/// Simulated time in microseconds since a history began.
using Micros = std::int64_t;

/// Something that a board did besides answering.
struct Effect {
    enum class Kind : std::uint8_t {
        kMode,   ///< a pin (`subject`) was made input (1), input with pull-up (2) or output (3)
        kLevel,  ///< a pin was written
        kDuty,   ///< PWM of a pin was set
        kMark,   ///< the service `W` executed its request number `value`
    };
    Kind kind;
    unsigned subject;
    int value;
    bool operator==(const Effect&) const = default;
};

/// What one pass of the firmware's loop did.
struct Pass {
    std::string read;           ///< bytes that it took from its receive buffer
    std::string text;           ///< what it took them for; a request ends with a line end
    bool rate_changed = false;  ///< it opened its line at another rate and dropped what was received
    std::vector<Effect> effects;
    std::string sent;
};

/// The project's own firmware, compiled for this machine over the fake hardware of its unit tests. Besides
/// `I` it has two services for this test: `W` (Marks; `W,w,NUMBER[,TEXT]` does nothing but say that it was
/// executed) and `D` (a range finder; `D,M`, `D,A,ms`, each value is one above the one before).
///
/// There is one board of each kind, because the firmware's board is a global variable; each power_up() makes
/// it new.
class Firmware {
  public:
    virtual ~Firmware() = default;

    /// A board that just got its power, name and settings as delivered. Returns what it sends, the banner.
    virtual std::string power_up(Micros now) = 0;
    /// One pass of the loop. `received`: its receive buffer, from which it takes what it reads. `room`: bytes
    /// that fit its send buffer. `idle`: all that it sent before has left.
    virtual void run(Micros now, std::string& received, std::size_t room, bool idle, Pass& pass) = 0;
    virtual unsigned baud() const = 0;
};

Firmware& firmware_with_extensions();
Firmware& firmware_of_04();
/// firmware_of_04() behind the parser of ASIP 0.4, with its known faults (tests/literal/model_04.hpp).
Firmware& firmware_with_parser_of_04();

}  // namespace truth
