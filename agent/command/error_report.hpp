// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"

namespace asip::agent {

/// The bus name of the service with this letter: its model's, else the letter; `io` where no service has it
/// (`#`).
std::string service_named(const session::ServiceTable& services, char letter);
/// The service of a request line.
std::string service_of_line(const session::ServiceTable& services, std::string_view line);
/// The request as it stands on its service's topic: without the service.
std::string_view request_of_line(std::string_view line);

/// Publishes `{"request":...}` as context: of a flood the oldest give way.
void publish_error(const Board& board, std::string_view service, const nlohmann::json& value, Effects& out);

/// A command that was not executed.
struct Failure {
    std::string_view service;
    std::string_view request;  ///< of a long one the beginning is reported
    std::string_view reason;
    std::string_view error;
    std::string_view by;        ///< its sender; empty: not known
    std::uint64_t dropped = 0;  ///< so many reports are missing before this one
};
/// For a sender who wants no answer: `{"request":"W,0,90","reason":"queue-full","error":"...","by":"anna"}`.
void report_failure(const Board& board, const Failure& failure, Effects& out);

}  // namespace asip::agent
