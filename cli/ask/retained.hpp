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

struct Retained {
    std::string topic;
    std::string payload;
    std::optional<std::uint32_t> expiry_seconds{};  ///< what is left of it
};

/// Fails where the broker is lost, or the user ends it.
Outcome<std::vector<Retained>> read_retained(const Environment& environment, BusSession& session,
                                             const std::vector<std::string>& filters);

/// Returns once the broker has taken all, or fails as BusSession::unanswered.
Outcome<void> put_retained(const Environment& environment, BusSession& session,
                           const std::vector<Retained>& messages);
/// The same, with nothing in place of what was there.
Outcome<void> clear_retained(const Environment& environment, BusSession& session,
                             const std::vector<std::string>& topics);

/// Asks again until nothing comes: a broker holds only a part ready for one reader. Returns how many topics
/// there were.
Outcome<std::size_t> clear_all_retained(const Environment& environment, BusSession& session,
                                        const std::vector<std::string>& filters);

/// No longer needed, and why.
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

/// Pure. Sorted by topic.
std::vector<Lingering> find_lingering(const bus::Topics& topics, const std::vector<Retained>& all);

/// By a retained state or description.
std::set<std::string> announced_boards(const bus::Topics& topics, const std::vector<Retained>& all);

std::vector<std::string> topics_of_board(const bus::Topics& topics, const std::vector<Retained>& all,
                                         const std::string& board);

/// By what is retained.
bool seems_alive(const bus::Topics& topics, const std::vector<Retained>& all, const std::string& board);

}  // namespace asip::cli
