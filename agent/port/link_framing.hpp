// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "agent/clients/client_framing.hpp"

namespace asip::agent {

/// Lines to a board and back: as they are, or each in a frame, as the published Java programs put them on
/// TCP.
class LinkFraming {
  public:
    using Kind = ClientFraming::Kind;

    /// `given` kUnknown: begins with `likely`, until the first byte of the other side shows the truth.
    LinkFraming(Kind given, Kind likely) : given_(given), kind_(given == Kind::kUnknown ? likely : given) {}

    Kind kind() const { return kind_; }
    /// What was sent before belongs to another connection.
    void opened();
    /// Where frames are sent, a line without an end waits for it.
    std::string outgoing(std::string_view bytes);
    /// Nothing: the other side frames otherwise, which holds from now on; the connection is to be opened
    /// anew, since what was sent was misread.
    std::optional<std::string> incoming(std::string_view bytes);

  private:
    Kind given_;
    Kind kind_;
    bool heard_ = false;
    std::string line_;
    protocol::UtfFrameReader frames_;
};

}  // namespace asip::agent
