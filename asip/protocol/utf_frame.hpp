#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/protocol/limits.hpp"

namespace asip::protocol {

/// Java's DataOutput.writeUTF: two bytes of big-endian length, then the text. Told apart from plain lines by
/// the first byte of a connection: a length below 8 kB starts below space, a line never does.
constexpr bool starts_utf_frame(unsigned char first_byte) {
    return first_byte < 0x20 && first_byte != '\n' && first_byte != '\r';
}

/// Fails when the text is longer than 65535 bytes or is not ASCII without NUL (what is beyond has another
/// encoding there).
Expected<std::string> encode_utf_frame(std::string_view text);

/// Cuts a byte stream into frames. A frame longer than the limit is skipped and counted; memory stays bounded
/// by it.
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
