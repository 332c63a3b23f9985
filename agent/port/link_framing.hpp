// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "agent/clients/client_framing.hpp"

namespace asip::agent {

/// How lines travel to a board and back: as they are, or each in a frame, as the published Java programs put
/// them on TCP between a board and its clients.
class LinkFraming {
  public:
    using Kind = ClientFraming::Kind;

    /// `given` kUnknown: begins with `likely`, until the other side shows by its first byte what it is.
    LinkFraming(Kind given, Kind likely) : given_(given), kind_(given == Kind::kUnknown ? likely : given) {}

    Kind kind() const { return kind_; }
    /// What was sent before belongs to another connection.
    void opened();
    /// The bytes that carry these; a line that has no end yet waits for it where frames are sent.
    std::string outgoing(std::string_view bytes);
    /// The lines in these bytes. Nothing: the other side frames otherwise, which holds from now on, and what
    /// it was sent meant something else to it: the connection is to be opened anew.
    std::optional<std::string> incoming(std::string_view bytes);

  private:
    Kind given_;
    Kind kind_;
    bool heard_ = false;
    std::string line_;
    protocol::UtfFrameReader frames_;
};

}  // namespace asip::agent
