// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "agent/bridge/effects.hpp"
#include "agent/counts/statistics.hpp"
#include "asip/protocol/message.hpp"

namespace asip::agent {

/// The newest value of each kind, at most kMaxKinds, that the board reports while there is no bus. Older ones
/// would be stale when the bus is back.
class OfflineValues {
  public:
    static constexpr std::size_t kMaxKinds = 64;

    /// A value that was replaced, or has no place, is counted.
    void keep(const protocol::ParsedLine& line, Statistics& statistics);
    /// Empties it; logs how many values were superseded.
    std::vector<protocol::ParsedLine> take(Effects& out);

  private:
    std::map<std::string, protocol::ParsedLine> newest_;
    std::uint64_t superseded_ = 0;
};

}  // namespace asip::agent
