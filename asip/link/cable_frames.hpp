// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace asip::link {

/// Begins the name of each board that a browser lends: none takes the name of a board of the room.
inline constexpr std::string_view kLentPrefix = "lent-";
/// Begins the place of a pupil's board: "student-3". No other lender gets such a place.
inline constexpr std::string_view kPupilPlace = "student-";

/// What one message of a cable is: the first byte of it, from the page to the agent and back.
enum class CableKind : char {
    kHello = 'H',    ///< gateway to agent, once: JSON, `{"by":"anna","vendor":"2341","product":"0043"}`, and
                     ///< `cable`, the page's name for it, and the `place` of a pupil
    kBytes = 'D',    ///< of the board, or to it
    kRate = 'R',     ///< to the page: digits; what follows is at this rate
    kRestart = 'Z',  ///< to the page: restart the board by DTR
    kName = 'N',     ///< to the page: the board is on the bus under this name
    kAlive = 'A',    ///< gateway to page: nothing; the way is there
    kEnd = 'E',      ///< nothing follows; why, for a person
    kTaken = 'T',    ///< agent to gateway: the same, since another cable has its place
};

struct CableMessage {
    CableKind kind;
    std::string payload;
};

inline constexpr std::size_t kMaxCablePayload = 65535;

/// Between gateway and agent a message is its kind, two bytes of length, and so many bytes. A payload that is
/// longer is cut.
inline std::string cable_frame(CableKind kind, std::string_view payload) {
    payload = payload.substr(0, kMaxCablePayload);
    std::string frame{static_cast<char>(kind), static_cast<char>(payload.size() >> 8),
                      static_cast<char>(payload.size() & 0xff)};
    return frame.append(payload);
}

/// Takes such messages out of a stream of bytes. Pure.
class CableReader {
  public:
    void take(std::string_view bytes) { waiting_ += bytes; }
    /// Nothing: none is whole.
    std::optional<CableMessage> next() {
        constexpr std::size_t kHead = 3;
        if (waiting_.size() < kHead) return std::nullopt;
        const auto byte = [this](std::size_t at) { return static_cast<unsigned char>(waiting_[at]); };
        const std::size_t size = (std::size_t{byte(1)} << 8) | byte(2);
        if (waiting_.size() < kHead + size) return std::nullopt;
        CableMessage message{static_cast<CableKind>(waiting_[0]), waiting_.substr(kHead, size)};
        waiting_.erase(0, kHead + size);
        return message;
    }

  private:
    std::string waiting_;
};

}  // namespace asip::link
