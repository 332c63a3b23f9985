// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "asip/bus/topics.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// A message that the broker keeps.
struct Retained {
    std::string topic;
    std::string payload;
    std::optional<std::uint32_t> expiry_seconds{};  ///< what is left of it
};

/// Reads what the broker has retained for `filters`: fails where the broker is lost, or the user ends it.
Outcome<std::vector<Retained>> read_retained(const Environment& environment, BusSession& session,
                                             const std::vector<std::string>& filters);

/// Empties retained topics; returns once the broker has taken it all, or fails as BusSession::unanswered.
Outcome<void> clear_retained(const Environment& environment, BusSession& session,
                             const std::vector<std::string>& topics);

/// The same for all that `filters` match, however much it is: the broker holds only a part of it ready for
/// one reader, so it is asked again until nothing comes. Returns how many topics there were.
Outcome<std::size_t> clear_all_retained(const Environment& environment, BusSession& session,
                                        const std::vector<std::string>& filters);

/// Something retained that is no longer needed, and why.
struct Lingering {
    enum class Kind {
        kGoneBoard,     ///< of a board that is "offline" or "lost"
        kCommand,       ///< would be executed again at each reconnection of a careless client
        kOrphan,        ///< a value of a board that is not announced
        kInvalidName,   ///< announced under a name that is not valid
        kUnreadable,    ///< a description that cannot be parsed or describes another board, an unknown state
        kGoneRegistry,  ///< of a registry that is not online
    };
    Kind kind = Kind::kGoneBoard;
    std::string topic;
    std::string board;  ///< empty where none is concerned
    std::string why;    ///< for a person
};

/// What of `all` is no longer needed. Pure. Sorted by topic.
std::vector<Lingering> find_lingering(const bus::Topics& topics, const std::vector<Retained>& all);

/// The boards of which a state or a description is retained.
std::set<std::string> announced_boards(const bus::Topics& topics, const std::vector<Retained>& all);

/// Every retained topic of one board.
std::vector<std::string> topics_of_board(const bus::Topics& topics, const std::vector<Retained>& all,
                                         const std::string& board);

/// Whether the board is there according to what is retained.
bool seems_alive(const bus::Topics& topics, const std::vector<Retained>& all, const std::string& board);

}  // namespace asip::cli
