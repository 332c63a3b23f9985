// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <unordered_map>

#include "agent/bridge/effects.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/board_session.hpp"

namespace asip::agent {

/// Matches lines of the board to the requests of point-to-point clients. A client takes the answer to a
/// question as proof of what it sent before. So the answer comes behind all errors; where a line of the
/// client may not have been executed, or one of the board was damaged, the client gets
/// `~#,C,10{BAD_CHECKSUM}`.
class ClientRequests {
  public:
    session::RequestOptions options(session::ClientId client, const protocol::Request& request,
                                    const session::Identity& board) const;
    void sent(session::RequestId id, session::ClientId client) { open_[id] = client; }

    /// A line for all clients, or for the one that it answers.
    void on_line(const session::BoardLine& line, const session::Identity& board, Effects& out) const;
    void on_garbage(Effects& out) const;
    void on_finished(const session::Finished& end, const session::Identity& board, Effects& out);

  private:
    std::unordered_map<session::RequestId, session::ClientId> open_;  // bounded by the session's queue
};

}  // namespace asip::agent
