// SPDX-License-Identifier: Apache-2.0
#include "agent/clients/client_framing.hpp"

#include <utility>

#include "asip/protocol/request.hpp"

namespace asip::agent {

void ClientFraming::assume(Kind kind) {
    if (kind_ == Kind::kUnknown) kind_ = kind;
}

std::vector<std::string> ClientFraming::decode(std::string_view bytes) {
    std::vector<std::string> result;
    if (bytes.empty()) return result;
    if (!std::exchange(found_, true))
        kind_ = protocol::starts_utf_frame(static_cast<unsigned char>(bytes.front())) ? Kind::kFrames
                                                                                      : Kind::kLines;
    const auto take = [&](std::string_view line) {
        if (const auto request = protocol::significant(line); !request.empty()) result.emplace_back(request);
    };
    if (kind_ == Kind::kLines) {
        lines_.push(bytes, take);
        return result;
    }
    frames_.push(bytes, [&](std::string_view frame) {
        // One request a frame, its newline optional.
        lines_.reset();
        lines_.push(std::string(frame) + "\n", take);
    });
    return result;
}

std::string ClientFraming::encode(std::string_view line) const {
    if (kind_ == Kind::kUnknown) return {};
    if (kind_ == Kind::kLines) return std::string(line) + "\n";
    auto frame = protocol::encode_utf_frame(line);
    return frame ? *frame : std::string();
}

}  // namespace asip::agent
