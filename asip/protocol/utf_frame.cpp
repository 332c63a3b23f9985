// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/utf_frame.hpp"

#include <algorithm>

namespace asip::protocol {

Expected<std::string> encode_utf_frame(std::string_view text) {
    if (text.size() > 0xffff) return fail("text is longer than a frame's 65535 bytes");
    const bool plain =
        std::all_of(text.begin(), text.end(), [](unsigned char c) { return c > 0 && c < 0x80; });
    if (!plain) return fail("text holds NUL or bytes beyond ASCII");
    std::string frame;
    frame.reserve(text.size() + 2);
    frame += static_cast<char>(text.size() >> 8);
    frame += static_cast<char>(text.size() & 0xff);
    frame += text;
    return frame;
}

UtfFrameReader::UtfFrameReader(std::size_t max_frame_bytes) : max_frame_bytes_(max_frame_bytes) {}

bool UtfFrameReader::take_frame(std::string_view& bytes) {
    for (;;) {
        while (header_bytes_ < 2 && !bytes.empty()) {
            remaining_ = (remaining_ << 8) | static_cast<unsigned char>(bytes.front());
            bytes.remove_prefix(1);
            if (++header_bytes_ == 2) skipping_ = remaining_ > max_frame_bytes_;
        }
        if (header_bytes_ < 2) return false;
        const auto piece = bytes.substr(0, remaining_);
        if (!skipping_) frame_.append(piece);
        remaining_ -= piece.size();
        bytes.remove_prefix(piece.size());
        if (remaining_ > 0) return false;
        header_bytes_ = 0;
        if (!skipping_) return true;
        ++overlong_frames_;
        skipping_ = false;
    }
}

}  // namespace asip::protocol
