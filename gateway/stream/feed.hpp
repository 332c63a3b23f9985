// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "gateway/instant.hpp"

namespace asip::gateway {

/// One event of a stream, whatever carries it.
struct StreamEvent {
    std::string_view kind;  ///< "value", "error", "board", "state", ..., "snapshot-end", "bookmark",
                            ///< "reset"
    std::string place;      ///< from which the stream can be resumed; empty: from the one before
    std::string data;       ///< a JSON object
};

/// What one subscription sends: the present state, `snapshot-end`, then the changes, one at a time as the
/// reader takes them. Pure.
class Feed {
  public:
    virtual ~Feed() = default;
    /// The next event; false: none is due.
    virtual bool next(StreamEvent& event, const Instant& now) = 0;
    /// next() gave nothing only because others have their turn first: call it again soon, without a wake.
    virtual bool more() const { return false; }
    /// Why nothing more comes, as a sentence; empty: it goes on.
    virtual std::string_view fault() const { return {}; }
    /// Called now and then, for what time alone makes due.
    virtual void tick(const Instant& now) = 0;

    /// Called when next() may have something again.
    std::function<void()> wake = [] {};
};

/// The fault of a feed that would keep more than its reader may have kept.
inline constexpr std::string_view kTooMuchKept =
    "too much would be kept for this client (max-client-bytes): close other streams, or choose narrower "
    "patterns";

/// As Server-Sent Events: appended to `out`.
void append_sse(std::string& out, const StreamEvent& event);
/// As a WebSocket message: the members of `data` behind `ref`, `event` and `place`.
std::string websocket_message(const StreamEvent& event, std::string_view ref_json);

}  // namespace asip::gateway
