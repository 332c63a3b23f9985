// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/utf_frame.hpp"

namespace asip::protocol {

namespace {

/// The bytes of the character at the beginning of `text`; 0: it is none that Java encodes as UTF-8 does.
std::size_t character(std::string_view text) {
    const auto byte = [text](std::size_t at) {
        return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
    };
    const auto follows = [&](std::size_t at) { return (byte(at) & 0xC0u) == 0x80u; };
    const auto lead = byte(0);
    if (lead < 0x80) return lead == 0 ? 0 : 1;
    if (lead >= 0xC2 && lead < 0xE0) return follows(1) ? 2 : 0;
    if (lead < 0xE0 || lead >= 0xF0 || !follows(1) || !follows(2)) return 0;
    const bool overlong = lead == 0xE0 && byte(1) < 0xA0, surrogate = lead == 0xED && byte(1) >= 0xA0;
    return overlong || surrogate ? 0 : 3;
}

}  // namespace

Expected<std::string> encode_utf_frame(std::string_view text) {
    if (text.size() > 0xffff) return fail("text is longer than a frame's 65535 bytes");
    std::string frame(2, '\0');
    frame.reserve(text.size() + 2);
    while (!text.empty()) {
        const auto size = character(text);
        size == 0 ? frame += '?' : frame += text.substr(0, size);
        text.remove_prefix(size == 0 ? 1 : size);
    }
    frame[0] = static_cast<char>((frame.size() - 2) >> 8);
    frame[1] = static_cast<char>((frame.size() - 2) & 0xff);
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
        skipping_ = false;
    }
}

}  // namespace asip::protocol
