#include "agent/client_framing.hpp"

namespace asip::agent {

std::vector<std::string> ClientFraming::decode(std::string_view bytes) {
    std::vector<std::string> result;
    if (bytes.empty()) return result;
    if (!framed_) framed_ = protocol::starts_utf_frame(static_cast<unsigned char>(bytes.front()));
    const auto take = [&](std::string_view line) { result.emplace_back(line); };
    if (!*framed_) {
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
    if (!framed()) return std::string(line) + "\n";
    auto frame = protocol::encode_utf_frame(line);
    return frame ? *frame : std::string();
}

}  // namespace asip::agent
