// SPDX-License-Identifier: Apache-2.0
#include "agent/port/link_framing.hpp"

#include <utility>

#include "asip/protocol/utf_frame.hpp"

namespace asip::agent {

void LinkFraming::opened() {
    heard_ = false;
    line_.clear();
    frames_ = protocol::UtfFrameReader();
}

std::string LinkFraming::outgoing(std::string_view bytes) {
    if (kind_ == Kind::kLines) return std::string(bytes);
    std::string frames;
    for (const char c : bytes) {
        line_ += c;
        if (c != '\n') continue;
        if (const auto frame = protocol::encode_utf_frame(line_)) frames += *frame;
        line_.clear();
    }
    return frames;
}

std::optional<std::string> LinkFraming::incoming(std::string_view bytes) {
    if (bytes.empty()) return std::string();
    if (!std::exchange(heard_, true) && given_ == Kind::kUnknown) {
        const bool frames = protocol::starts_utf_frame(static_cast<unsigned char>(bytes.front()));
        const auto seen = frames ? Kind::kFrames : Kind::kLines;
        if (std::exchange(kind_, seen) != seen) return std::nullopt;
    }
    if (kind_ == Kind::kLines) return std::string(bytes);
    std::string lines;
    frames_.push(bytes, [&](std::string_view frame) {
        lines += frame;
        if (!frame.ends_with('\n')) lines += '\n';
    });
    return lines;
}

}  // namespace asip::agent
