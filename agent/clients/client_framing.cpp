// SPDX-License-Identifier: Apache-2.0
#include "agent/clients/client_framing.hpp"

#include <algorithm>
#include <utility>

#include "asip/protocol/request_end.hpp"

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
        // In pieces: a burst of requests without line ends is longer than a line may be.
        for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), protocol::kMaxRequestBytes)))
            read_lines(bytes.substr(0, protocol::kMaxRequestBytes), result);
        return result;
    }
    frames_.push(bytes, [&](std::string_view frame) {
        // One request a frame, its newline optional.
        lines_.reset();
        lines_.push(std::string(frame) + "\n", take);
    });
    return result;
}

void ClientFraming::read_lines(std::string_view bytes, std::vector<std::string>& requests) {
    lines_.push(bytes, [&](std::string_view line) { split(line, requests); });
    lines_.drop(protocol::ignored_before(lines_.partial()));
    while (!extended_) {
        const auto next = protocol::next_request(lines_.partial());
        if (next == std::string_view::npos) break;
        add(lines_.partial().substr(0, next), requests);
        lines_.drop(next);
    }
}

// A line end says that a request is complete; what stands before another request in its line has to look so.
void ClientFraming::split(std::string_view line, std::vector<std::string>& requests) {
    line = protocol::significant(line);
    while (!extended_) {
        const auto next = protocol::next_request(line);
        if (next == std::string_view::npos) break;
        add(line.substr(0, next), requests);
        line.remove_prefix(next);
    }
    for (const std::string_view extension : {"#,E", "#,X", "#,I"})
        if (line.starts_with(extension)) extended_ = true;
    if (!line.empty()) requests.emplace_back(line);
}

void ClientFraming::add(std::string_view request, std::vector<std::string>& requests) {
    request = protocol::significant(request);
    if (!request.empty()) (protocol::is_whole_request(request) ? requests : halves_).emplace_back(request);
}

bool ClientFraming::waits_for_silence() const {
    return kind_ == Kind::kLines && !extended_ && lines_.partial_bytes() > 0;
}

std::vector<std::string> ClientFraming::after_silence() {
    std::vector<std::string> result;
    if (!waits_for_silence()) return result;
    const auto request = protocol::significant(lines_.partial());
    if (!request.empty())
        (protocol::is_whole_after_silence(request) ? result : halves_).emplace_back(request);
    lines_.reset();
    return result;
}

std::string ClientFraming::encode(std::string_view line) const {
    if (kind_ == Kind::kUnknown) return {};
    if (kind_ == Kind::kLines) return std::string(line) + "\n";
    auto frame = protocol::encode_utf_frame(line);
    return frame ? *frame : std::string();
}

}  // namespace asip::agent
