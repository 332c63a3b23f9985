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

/// As a board file has it.
struct PartConfig {
    std::string kind;  ///< "led", "button", ... (docs/asip-sim.md lists them)
    /// {{"pin", 13}, {"active_low", true}}. Pins are Arduino numbers, or "A0".
    nlohmann::json settings = nlohmann::json::object();
    /// Unique on the board. Empty: kind and pin, "led13".
    std::string name{};
};

/// From tests, or from a JSON file.
struct BoardConfig {
    std::string name = "board";
    std::string board = "uno";    ///< "uno", "mega", "leonardo", ...
    std::filesystem::path image;  ///< .elf or Intel .hex
    std::vector<PartConfig> parts;
    /// Shared with other rovers; null: nowhere.
    std::shared_ptr<world::World> world{};

    std::filesystem::path eeprom;  ///< kept in this file from run to run; empty: starts erased every time
    std::uint32_t frequency = 16'000'000;
    char uart = 0;  ///< '0'..'3'; 0: the board's usual one

    /// 0 follows the board. Otherwise bytes are garbled while the board's rate is more than 3 % away.
    std::uint32_t host_baud = 0;
};

}  // namespace asip::sim
