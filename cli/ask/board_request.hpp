// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>

#include "asip/bus/request/reply.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {

/// A command ready to be published: checked, with nothing about its answer yet.
struct BoardCommand {
    std::string topic;
    std::string payload;
    std::string line;    ///< the whole request, for people
    std::string target;  ///< BOARD or BOARD/SERVICE
    std::string safe{};  ///< the request that undoes it; empty: none is known
    bool plain = false;  ///< for a board that takes part by names only: it reads request lines, and no JSON

    /// To be given to a session.
    caller::Command to_send() const;
};

/// `words` as typed (a name and its arguments, or one JSON object) against the service's model. A service
/// without a model takes a tag and its parameters. Fails with kExitUsage, the reason and how the command is
/// used.
Outcome<BoardCommand> make_command(const Environment& environment, const KnownBoard& board,
                                   const model::ServiceInfo& service, std::span<const std::string> words);
/// A request line for the board itself.
Outcome<BoardCommand> make_raw_command(const Environment& environment, const std::string& board,
                                       const std::string& line);

/// Sends and waits for the one final answer, which may say that none came. Fails where the user asks to end.
Outcome<bus::Reply> ask_board(BusSession& session, caller::Command command);

/// The user of asipctl, for requests that name their sender: the user of the broker, else the login name.
std::string who_asks(const Environment& environment);

/// What an answer means for the exit status: 0, 1 (refused by the agent or the board) or 4 (the board was
/// silent).
int exit_status(const bus::Reply& reply);
/// What is printed for a success: `ok`, or what the board answered (a raw line as it came, JSON otherwise).
std::string answer_text(const bus::Reply& reply);
/// Why it failed, for a table that has the status beside it.
std::string why_not(const bus::Reply& reply);
/// The same as a line of its own, with what to try.
std::string note_of(const std::string& board, const bus::Reply& reply);
/// The same as the failure of asipctl; `where` stands before it: `desk: `.
Failure failure_of(const bus::Reply& reply, const std::string& where);

/// The answer to a command that the user did not wait for.
bus::Reply not_waited_for();
/// That for a board that was not asked: it is lost, and `so` (for a person: `nothing was sent`).
bus::Reply refused_as_lost(const bus::BoardItem& board, const std::string& so);

/// Finds a board that is there to be commanded: known, and neither "offline" nor "lost".
Outcome<KnownBoard> find_living_board(BoardSource& source, const std::string& name);

}  // namespace asip::cli
