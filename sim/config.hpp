// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace asip::sim {
namespace world {
class World;
}

/// Something wired to a board's pins, as a board file has it.
struct PartConfig {
    std::string kind;  ///< "led", "button", ... (docs/asip-sim.md lists them)
    /// The members that this kind has: {{"pin", 13}, {"active_low", true}}. Pins are Arduino pin numbers, or
    /// "A0".
    nlohmann::json settings = nlohmann::json::object();
    /// Unique on the board; what commands and printed changes call it. Empty: kind and pin, "led13".
    std::string name{};
};

/// A board: image, chip, parts. Built in code by tests, read from a JSON file by asip-sim.
struct BoardConfig {
    std::string name = "board";
    std::string board = "uno";    ///< "uno", "mega", "leonardo", ...
    std::filesystem::path image;  ///< .elf or Intel .hex
    std::vector<PartConfig> parts;
    /// Where its rover drives, shared with the boards of other rovers; null: nowhere.
    std::shared_ptr<world::World> world{};

    std::filesystem::path eeprom;  ///< kept in this file from run to run; empty: starts erased every time
    std::uint32_t frequency = 16'000'000;
    char uart = 0;  ///< '0'..'3'; 0: the board's usual one

    /// Rate of the host's side of the line. 0 follows the board, whatever rate it sets (bytes are always
    /// understood). Otherwise bytes are garbled both ways while the board's rate is more than 3 % away, as
    /// they are on a real line.
    std::uint32_t host_baud = 0;
};

}  // namespace asip::sim
