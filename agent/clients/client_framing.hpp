// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/protocol/line_reader.hpp"
#include "asip/protocol/request.hpp"
#include "asip/protocol/utf_frame.hpp"

namespace asip::agent {

/// How a point-to-point client frames its messages: plain lines, or Java's writeUTF frames. Given, or
/// recognised by the first byte that comes; until then nothing can be sent.
class ClientFraming {
  public:
    enum class Kind { kUnknown, kLines, kFrames };

    explicit ClientFraming(Kind kind = Kind::kUnknown) : kind_(kind), found_(kind != Kind::kUnknown) {}

    Kind kind() const { return kind_; }
    /// The client stayed silent: `kind` holds unless its first byte contradicts.
    void assume(Kind kind);

    /// The request lines that these bytes complete. Before a client uses an extension, a whole request on
    /// plain lines also ends where the next one begins.
    std::vector<std::string> decode(std::string_view bytes);
    std::vector<std::string> after_silence();
    bool waits_for_silence() const;
    /// Halves of requests since the last call; they are not executed.
    std::vector<std::string> take_halves() { return std::exchange(halves_, {}); }
    /// Nothing: the framing is not known yet, or the line cannot be framed.
    std::string encode(std::string_view line) const;

    bool operator==(const ClientFraming&) const = default;

  private:
    void read_lines(std::string_view bytes, std::vector<std::string>& requests);
    void split(std::string_view line, std::vector<std::string>& requests);
    void add(std::string_view request, std::vector<std::string>& requests);

    Kind kind_;
    bool found_;  // given, or seen in what the client sent
    protocol::LineReader lines_{protocol::kMaxBoardLineBytes, protocol::kRequestEnds};
    protocol::UtfFrameReader frames_;
    std::vector<std::string> halves_;
    bool extended_ = false;  // it uses an extension, and so ends its lines
};

}  // namespace asip::agent
