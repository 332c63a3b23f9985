// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>

#include "asip/bus/request/reply.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {

/// Checked, and ready to be published.
struct BoardCommand {
    std::string topic;
    std::string payload;
    std::string line;    ///< the whole request, for people
    std::string target;  ///< BOARD or BOARD/SERVICE
    std::string safe{};  ///< the request that undoes it; empty: none is known
    bool plain = false;  ///< for a board that takes part by names only: it reads request lines, and no JSON

    /// For a session.
    caller::Command to_send() const;
};

/// From typed `words` (a name and arguments, or a JSON object) by the service's model, else a tag and its
/// parameters. Fails with kExitUsage and how the command is used.
Outcome<BoardCommand> make_command(const Environment& environment, const KnownBoard& board,
                                   const model::ServiceInfo& service, std::span<const std::string> words);
/// A request line for the board itself.
Outcome<BoardCommand> make_raw_command(const Environment& environment, const std::string& board,
                                       const std::string& line);

/// Waits for the one final answer, which may say that none came. Fails where the user asks to end.
Outcome<bus::Reply> ask_board(BusSession& session, caller::Command command);

/// The sender of requests: the user of the broker, else the login name.
std::string who_asks(const Environment& environment);

/// 0, 1 (refused by the agent or the board) or 4 (the board was silent).
int exit_status(const bus::Reply& reply);
/// For a success: `ok`, or what the board answered.
std::string answer_text(const bus::Reply& reply);
/// For a table that has the status beside it.
std::string why_not(const bus::Reply& reply);
/// As a line of its own, with what to try.
std::string note_of(const std::string& board, const bus::Reply& reply);
/// As the failure of asipctl; `where` stands first: `desk: `.
Failure failure_of(const bus::Reply& reply, const std::string& where);

bus::Reply not_waited_for();
/// The board is lost, and `so`, for a person (`nothing was sent`).
bus::Reply refused_as_lost(const bus::BoardItem& board, const std::string& so);

/// Known, and neither "offline" nor "lost".
Outcome<KnownBoard> find_living_board(BoardSource& source, const std::string& name);

}  // namespace asip::cli
