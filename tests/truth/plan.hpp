// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tests/truth/dice.hpp"

namespace truth {

struct Span {
    Micros from = 0;
    Micros until = 0;
    bool covers(Micros time) const { return time >= from && time < until; }
};

/// What happens to one byte of one direction, the first byte being number 0.
struct ByteFault {
    enum class Kind : std::uint8_t {
        kLost,
        kTwice,
        kChanged,  ///< its bit number `bit`
        kDelayed,  ///< it and all behind it come so much later
        kCut,      ///< it and all behind it are lost for so long
    };
    std::uint64_t byte = 0;
    Kind kind = Kind::kLost;
    unsigned bit = 0;
    Micros lasts = 0;
};

/// What is wrong with one direction of a line.
struct WirePlan {
    Span damaged;  ///< when the following happen, each with so much probability per byte
    double lose = 0;
    double lose_several = 0;  ///< up to 30 bytes in a row
    double twice = 0;
    double change = 0;
    double insert = 0;
    Micros latency = 0;
    Micros bunch = 1;  ///< bytes come together at multiples of this, as from a USB serial chip
    std::vector<Span> stalls;
    std::vector<ByteFault> faults;

    bool damages() const { return lose + lose_several + twice + change + insert > 0; }
};

/// What befalls board, link or agent at some time.
struct Incident {
    enum class Kind : std::uint8_t {
        kBoardReset,    ///< its reset button; the link stays open
        kUnplug,        ///< no power and no link for `lasts`
        kHang,          ///< the board stops for `lasts`, then goes on where it was
        kDie,           ///< the board stops for `lasts`, then starts anew
        kReopen,        ///< the port is closed and opened, which restarts the board
        kAgentRestart,  ///< another session takes the place of this one, at the line's start rate
    };
    Kind kind;
    Micros at;
    Micros lasts;
};

/// How a client behaves.
struct ClientPlan {
    Micros pause = 0;  ///< between two commands, about
    double bad = 0;    ///< how many of its commands are
    double longs = 0;
    double burst = 0;  ///< chance that several commands come at once
    bool settings = false;
    bool only_marks = false;  ///< requests of which each looks different
};

/// Everything about a history that is decided before it begins.
struct Plan {
    std::uint64_t seed = 0;
    bool extensions = true;
    bool parser_of_04 = false;  ///< without extensions: requests are parsed as ASIP 0.4 did
    enum class Checksum : std::uint8_t { kAuto, kAlways, kNever } checksum = Checksum::kAuto;
    bool tcp = false;  ///< the session knows of no line rate
    unsigned max_baud = 0;
    Micros board_pass = 0;                ///< time that one pass of the board's loop takes
    Micros idle_pass = 2 * kMillisecond;  ///< the same while the board has nothing to do
    Micros boot = 0;                      ///< until the board's banner
    WirePlan to_board, to_host;
    double rate_fails = 0;
    std::vector<ClientPlan> clients;
    std::vector<Incident> incidents;
    Micros active = 0;  ///< commands come until then

    /// Nothing goes wrong: no byte is damaged or late, and nothing restarts.
    bool calm() const;
};

Plan draw_plan(std::uint64_t seed, Dice& dice);
std::string describe(const Plan& plan);
const char* to_string(Incident::Kind kind);

}  // namespace truth
