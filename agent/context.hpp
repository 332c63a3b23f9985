#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "agent/effects.hpp"
#include "agent/service_table.hpp"
#include "asip/bus/topics.hpp"
#include "asip/session/identity.hpp"

namespace asip::agent {

struct ContextOptions {
    std::string terminator;      ///< put behind each raw line on `/out`
    bool retain_values = false;  ///< decoded values are retained
};

/// Lines of the board to the context bus: raw, decoded by their service's model, and errors.
class Context {
  public:
    Context(const bus::Topics& topics, ContextOptions options)
        : topics_(topics), options_(std::move(options)) {}

    void on_line(const std::string& board, std::string_view line, const session::Identity& identity,
                 const ServiceTable& services, Effects& out);

    /// Events their model could not decode.
    std::uint64_t undecoded() const { return undecoded_; }

  private:
    bus::Topics topics_;
    ContextOptions options_;
    std::uint64_t undecoded_ = 0;
};

}  // namespace asip::agent
