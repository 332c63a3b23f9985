// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/protocol/limits.hpp"

namespace asip::protocol {

// The framing of clients written in Java (DataOutput.writeUTF): two bytes of big-endian length, then the
// text.

/// Whether a connection whose first byte is this one sends such frames. The length of one request begins with
/// a zero; the other control characters are some that boards skip before a plain line.
constexpr bool starts_utf_frame(unsigned char first_byte) {
    return first_byte == 0;
}

/// One frame with its length. A zero, what is beyond U+FFFF, and bytes that are no UTF-8 become `?`: Java
/// encodes them otherwise. Fails when the text is longer than 65535 bytes.
Expected<std::string> encode_utf_frame(std::string_view text);

/// Cuts a byte stream into frames, given in pieces of any size. A frame longer than the limit is skipped and
/// counted, and the next one is read as usual; memory never exceeds the limit.
class UtfFrameReader {
  public:
    explicit UtfFrameReader(std::size_t max_frame_bytes = kMaxPayloadBytes);

    /// Calls `on_frame(std::string_view)` for each frame that these bytes complete, empty ones too. The view
    /// is valid during the call only; `on_frame` must not call push().
    template <class OnFrame>
    void push(std::string_view bytes, OnFrame&& on_frame) {
        while (take_frame(bytes)) {
            const std::string frame = std::move(frame_);
            frame_.clear();
            on_frame(std::string_view(frame));
        }
    }

    /// How many frames were skipped since construction.
    std::uint64_t overlong_frames() const { return overlong_frames_; }

  private:
    bool take_frame(std::string_view& bytes);

    std::size_t max_frame_bytes_;
    int header_bytes_ = 0;
    std::size_t remaining_ = 0;
    bool skipping_ = false;
    std::string frame_;
    std::uint64_t overlong_frames_ = 0;
};

}  // namespace asip::protocol
