// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <charconv>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "gateway/instant.hpp"

namespace asip::gateway {

/// A place in a stream: `EPOCH-N`. N steps by one; another epoch is another run of the gateway.
struct Place {
    std::string epoch;
    std::uint64_t number = 0;

    std::string text() const { return epoch + "-" + std::to_string(number); }
    friend bool operator==(const Place&, const Place&) = default;
};

/// Nothing: not what text() wrote.
inline std::optional<Place> parse_place(std::string_view text) {
    const auto dash = text.rfind('-');
    if (dash == std::string_view::npos || dash == 0 || text.size() > 64) return std::nullopt;
    Place place;
    place.epoch = text.substr(0, dash);
    const auto* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + dash + 1, end, place.number);
    if (error != std::errc() || rest != end) return std::nullopt;
    return place;
}

/// In each of many services.
struct Places {
    std::string epoch;
    std::map<std::string, std::uint64_t, std::less<>> services;  ///< "BOARD/SERVICE" -> number
    std::optional<std::uint64_t> others;  ///< of those not named: the reader had all that there was
};

struct StreamEvent {
    std::string_view kind;  ///< "value", "error", "board", "state", ..., "snapshot-end", "bookmark",
                            ///< "reset"
    std::string place;      ///< from which the stream can be resumed; empty: from the one before
    std::string data;       ///< a JSON object
};

/// What a subscription sends: the present state, `snapshot-end`, then changes, as the reader takes them.
/// Pure.
class Feed {
  public:
    virtual ~Feed() = default;
    /// False: none is due.
    virtual bool next(StreamEvent& event, const Instant& now) = 0;
    /// Others have their turn first: call next() again soon.
    virtual bool more() const { return false; }
    /// Why nothing more comes; empty: it goes on.
    virtual std::string_view fault() const { return {}; }
    /// For what time alone makes due.
    virtual void tick(const Instant& now) = 0;

    /// next() may have something again.
    std::function<void()> wake = [] {};
};

/// The feed would keep more than its reader may have kept.
inline constexpr std::string_view kTooMuchKept =
    "too much would be kept for this client (max-client-bytes): close other streams, or choose narrower "
    "patterns";

/// As Server-Sent Events.
void append_sse(std::string& out, const StreamEvent& event);
/// The members of `data` behind `ref`, `event` and `place`.
std::string websocket_message(const StreamEvent& event, std::string_view ref_json);

}  // namespace asip::gateway
