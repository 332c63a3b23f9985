// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "asip/bus/registry/label_selector.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct GroupCommand {
    Target target;  ///< the board may be a pattern; without a service: a request line
    bus::LabelSelector labels;
    std::vector<std::string> words;
    std::string raw;  ///< a request line instead of words
    bool no_wait = false;
    std::size_t in_flight = 16;  ///< how many may be unanswered at a time
    OutputOptions output{};
};

/// Sends it to each chosen board that has not said goodbye, and prints the answers; to none where it is wrong
/// for one. kExitOk, or what the first failure means.
int send_to_group(const GroupCommand& group, Environment& environment, BusSession& session,
                  BoardSource& source);

}  // namespace asip::cli
