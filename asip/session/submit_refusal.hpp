// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::session {

/// Why submit() did not take a request. Nothing of it was sent.
enum class Refusal {
    /// Not a request line: `S,t[,...]`, printable characters, at most kMaxRequestBytes, and none of `#,B`,
    /// `#,C` and `#,V`, which are the session's own.
    kInvalid,
    /// Longer than Extensions::longest_request() of this board.
    kTooLong,
    /// kMaxQueuedPerClient requests of this client wait already, or kMaxQueued of all clients; of urgent ones
    /// kMaxUrgent.
    kQueueFull,
    /// The link is down, the board is silent, or it was not identified since link_up.
    kNoBoard,
    /// It stores a name on the board, as others did before: see NameBudget.
    kTooManyNames,
};

/// The word of asip/bus/request/refusal_reasons.hpp: several causes share one.
const char* to_string(Refusal refusal);

}  // namespace asip::session
