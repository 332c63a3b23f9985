#pragma once
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace asip::sim {

/// What the command line asks for.
struct Options {
    std::vector<std::string> boards;  ///< board files or images
    std::string board = "uno";        ///< for images
    std::vector<std::string> links;   ///< one a board, in their order
    std::vector<int> tcp_ports;       ///< one a board
    bool json = false;
    std::optional<std::filesystem::path> socket;
    bool no_socket = false;
    std::chrono::microseconds slice{0};  ///< 0: by the number of boards
    unsigned threads = 0;                ///< 0: one a core

    bool control = false;  ///< asip-sim ctl
    std::vector<std::string> command;
};

/// The options, or the exit status if the program is done already (--help, --version, a bad option).
struct Parsed {
    Options options;
    std::optional<int> exit_status;
};
Parsed parse_options(int argc, char** argv);

}  // namespace asip::sim
