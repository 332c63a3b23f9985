// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>

#include "asip/expected.hpp"
#include "sim/config.hpp"

namespace asip::sim {

/// What a board file holds beyond the board itself: how asip-sim offers it.
struct BoardFile {
    BoardConfig board;
    /// The file of its world, of which `board` has one of its own; empty: none.
    std::filesystem::path world;
    std::filesystem::path link;  ///< symbolic link to the pseudo-terminal; empty: none
    int tcp_port = -1;           ///< on 127.0.0.1; 0: any free one; -1: none
    bool reset_on_open = false;  ///< reset when a program opens the port, as an Uno does
};

/// Reads a board file. Paths in it are relative to the file. The error is one line: file, line and column of
/// a syntax error or the place in the document, and what is wrong.
Expected<BoardFile> load_board_file(const std::filesystem::path& file);
/// The same from text; `file` is only for the errors and relative paths.
Expected<BoardFile> parse_board_file(std::string_view text, const std::filesystem::path& file);

}  // namespace asip::sim
