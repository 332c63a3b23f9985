// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::cli {

/// One line of `asipctl events --logs`.
struct LogLine {
    std::string board;
    std::string source;  ///< `board`, `SERVICE`, or `agent`
    std::string level;   ///< `info`, `warning` or `error`
    std::string text;
};

/// What a message means for a person who looks for trouble: a `!` line of the board, an error of a service,
/// or a line of the agent; nothing for any other. Anybody may have written it; not yet fit for a terminal.
std::optional<LogLine> log_line(const bus::Topics& topics, const mqtt::Message& message);

}  // namespace asip::cli
