// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "asip/protocol/parsed_line.hpp"

namespace asip::agent {

struct ContextOptions {
    std::string terminator;      ///< put behind each raw line
    bool retain_values = false;  ///< decoded values are retained
    bool client_side = false;    ///< raw lines go to `/in`, see BridgeOptions
};

/// Lines of the board to the context bus: raw, decoded by their service's model, and errors.
class Context {
  public:
    /// `board` must outlive it.
    Context(const Board& board, ContextOptions options) : board_(board), options_(std::move(options)) {}

    /// `by`: who sent the request that the line is an error of; empty: not known.
    void on_line(const protocol::ParsedLine& line, Effects& out, std::string_view by = {});

  private:
    const Board& board_;
    ContextOptions options_;
};

}  // namespace asip::agent
