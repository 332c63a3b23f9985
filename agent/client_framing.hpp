#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/protocol/line_reader.hpp"
#include "asip/protocol/utf_frame.hpp"

namespace asip::agent {

/// How one point-to-point client frames its messages: plain lines, or Java's writeUTF frames, told apart by
/// the first byte it sends. A client that has sent nothing yet gets plain lines.
class ClientFraming {
  public:
    /// Request lines that these bytes complete; a frame may hold several lines.
    std::vector<std::string> decode(std::string_view bytes);
    std::string encode(std::string_view line) const;
    bool framed() const { return framed_.value_or(false); }

  private:
    std::optional<bool> framed_;
    protocol::LineReader lines_;
    protocol::UtfFrameReader frames_;
};

}  // namespace asip::agent
