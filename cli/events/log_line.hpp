// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::cli {

struct LogLine {
    std::string board;
    std::string source;  ///< `board`, `SERVICE`, or `agent`
    std::string level;   ///< `info`, `warning` or `error`
    std::string text;
};

/// A `!` line of the board, an error, or a line of the agent; nothing: another message. Not yet fit for a
/// terminal.
std::optional<LogLine> log_line(const bus::Topics& topics, const mqtt::Message& message);

}  // namespace asip::cli
