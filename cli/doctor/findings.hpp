// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/bus/topics.hpp"
#include "cli/ask/retained.hpp"
#include "cli/doctor/finding.hpp"
#include "cli/doctor/machine.hpp"

namespace asip::cli {

/// From one board.
struct PingResult {
    std::optional<bus::Reply> reply;  ///< none: there was no answer at all
    bool denied = false;              ///< the broker does not let us ask it
    bool properties_lost = false;     ///< we speak MQTT 5, and what came back was without its properties
};

/// For the checks below, which are pure.
struct Observations {
    bus::Topics topics{};
    std::string broker{};
    bool v5 = true;
    std::size_t max_packet_bytes = 0;  ///< the limit of the broker; 0: it named none
    /// Anybody may command boards; nothing: not known.
    std::optional<bool> open{};
    bool loopback = false;  ///< the broker's address is one of this machine alone
    std::optional<std::chrono::duration<double>> acknowledged{};  ///< a message out and back, median; QoS 1
                                                                  ///< unless the broker refuses QoS 1

    std::vector<Retained> retained{};
    bool home_assistant = false;            ///< it, or something that speaks to it, uses this broker
    std::vector<std::string> registries{};  ///< online by their retained state
    std::string registry{};                 ///< that answered; empty: none
    std::vector<bus::BoardItem> boards{};   ///< as the registry, else the bus, has them
    std::map<std::string, std::string> bad_documents{};  ///< topic, reason
    /// By board: the sessions that announced it while we looked.
    std::map<std::string, std::set<std::string>> sessions{};
    std::map<std::string, PingResult> pings{};  ///< of boards whose state is "online"
    /// By our clock, around the registry's answers.
    std::chrono::system_clock::time_point asked{}, answered{};
    Machine machine{};
};

Findings check_broker(const Observations& seen);
Findings check_registry(const Observations& seen);
Findings check_boards(const Observations& seen);
Findings check_states(const Observations& seen);
Findings check_bridges(const Observations& seen);
Findings check_warnings(const Observations& seen);
Findings check_exports(const Observations& seen);
Findings check_retained(const Observations& seen);
Findings check_names(const Observations& seen);
Findings check_conflicts(const Observations& seen);
Findings check_clocks(const Observations& seen);

/// In that order.
Findings check_all(const Observations& seen);

}  // namespace asip::cli
