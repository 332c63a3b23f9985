#pragma once
#include <optional>
#include <string>

#include "agent/bridge.hpp"
#include "asip/expected.hpp"
#include "asip/mqtt/options.hpp"

namespace asip::agent {

enum class ResetPolicy { kNever, kAlways, kIfSilent };

struct AgentOptions {
    BridgeOptions bridge;
    mqtt::Options mqtt;
    model::ModelSet models;
    std::string serial;  ///< device; empty: `tcp`
    std::string tcp;     ///< HOST:PORT; empty: `serial`
    std::string listen;  ///< [HOST:]PORT for point-to-point clients; empty: none
    unsigned baud = 57600;
    ResetPolicy reset = ResetPolicy::kIfSilent;
};

/// From command line, environment and configuration file. The error is the exit status to end with; whatever
/// there is to say has been printed.
Expected<AgentOptions, int> read_options(int argc, const char* const* argv);

}  // namespace asip::agent
