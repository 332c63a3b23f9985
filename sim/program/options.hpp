// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/program/options.hpp"

namespace asip::sim {

struct Options {
    std::vector<std::string> boards;  ///< board files or images
    std::string board = "uno";        ///< for images
    std::vector<std::string> links;   ///< at most one for each board, in their order
    std::vector<int> tcp_ports;       ///< at most one for each board
    bool json = false;
    std::optional<std::filesystem::path> socket;  ///< none: one for each user
    bool no_socket = false;
    std::chrono::microseconds slice{0};  ///< 0: by the number of boards
    unsigned threads = 0;                ///< 0: one for each core

    std::string publish_world;  ///< the name of the boards' world on the bus; empty: it is not there
    program::BrokerOptions broker{};

    std::vector<std::string> command;  ///< asip-sim ctl: its words; otherwise empty
};

/// From command line, environment and configuration file. The error is the exit status; all has been printed.
Expected<Options, int> read_options(int argc, const char* const* argv);

}  // namespace asip::sim
