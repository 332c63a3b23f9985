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

/// The length of one request begins with a zero; boards skip other control characters before a plain line.
constexpr bool starts_utf_frame(unsigned char first_byte) {
    return first_byte == 0;
}

/// With its length. A zero, what is beyond U+FFFF, and bytes that are no UTF-8 become `?`: Java encodes them
/// otherwise. Fails above 65535 bytes.
Expected<std::string> encode_utf_frame(std::string_view text);

/// Cuts bytes into frames. A frame above the limit is skipped.
class UtfFrameReader {
  public:
    explicit UtfFrameReader(std::size_t max_frame_bytes = kMaxPayloadBytes);

    /// For each complete frame, empty ones too. The view is valid during the call only; `on_frame` must not
    /// call push().
    template <class OnFrame>
    void push(std::string_view bytes, OnFrame&& on_frame) {
        while (take_frame(bytes)) {
            const std::string frame = std::move(frame_);
            frame_.clear();
            on_frame(std::string_view(frame));
        }
    }

    bool operator==(const UtfFrameReader&) const = default;

  private:
    bool take_frame(std::string_view& bytes);

    std::size_t max_frame_bytes_;
    int header_bytes_ = 0;
    std::size_t remaining_ = 0;
    bool skipping_ = false;
    std::string frame_;
};

}  // namespace asip::protocol
