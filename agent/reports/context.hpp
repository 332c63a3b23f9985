// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "agent/bridge/effects.hpp"
#include "asip/bus/topics.hpp"
#include "asip/protocol/parsed_line.hpp"
#include "asip/session/identity.hpp"
#include "asip/session/service_table.hpp"

namespace asip::agent {

struct ContextOptions {
    std::string terminator;      ///< put behind each raw line
    bool retain_values = false;  ///< decoded values are retained
    bool client_side = false;    ///< raw lines go to `/in`, see BridgeOptions
};

/// Lines of the board to the context bus: raw, decoded by their service's model, and errors.
class Context {
  public:
    Context(const bus::Topics& topics, ContextOptions options)
        : topics_(topics), options_(std::move(options)) {}

    /// `by`: who sent the request that the line is an error of; empty: not known.
    void on_line(const std::string& board, const protocol::ParsedLine& line,
                 const session::Identity& identity, const session::ServiceTable& services, Effects& out,
                 std::string_view by = {});

  private:
    bus::Topics topics_;
    ContextOptions options_;
};

}  // namespace asip::agent
