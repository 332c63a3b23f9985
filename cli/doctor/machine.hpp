// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/doctor/finding.hpp"

namespace asip::cli {

struct SerialPort {
    std::string path;
    bool may_use = false;  ///< we may read and write it
    std::string group;     ///< of the device file
};

/// As far as it gets in the way of boards.
struct Machine {
    std::vector<SerialPort> ports;
    bool modem_manager = false;  ///< runs here
    bool brltty = false;         ///< runs here, or is started by udev for some converters
    bool udev_rule = false;      ///< that keeps it off our boards
    bool starts_agents = false;  ///< for each board that is plugged in
};

/// `root`: `/`, or another one for tests.
Machine look_at_machine(const std::filesystem::path& root = "/");

Findings check_machine(const Machine& machine);

}  // namespace asip::cli
