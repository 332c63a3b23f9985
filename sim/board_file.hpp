// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>

#include "asip/expected.hpp"
#include "sim/config.hpp"

namespace asip::sim {

/// How asip-sim offers a board.
struct BoardFile {
    BoardConfig board;
    /// Empty: none, or `board` has its own.
    std::filesystem::path world;
    std::filesystem::path link;  ///< symbolic link to the pseudo-terminal; empty: none
    int tcp_port = -1;           ///< on 127.0.0.1; 0: any free one; -1: none
    bool reset_on_open = false;  ///< reset when a program opens the port, as an Uno does
};

/// Paths are relative to the file. Errors: file, line and column or place, and what is wrong.
Expected<BoardFile> load_board_file(const std::filesystem::path& file);
/// `file`: for errors and relative paths.
Expected<BoardFile> parse_board_file(std::string_view text, const std::filesystem::path& file);

}  // namespace asip::sim
