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

/// Values that the board reports while there is no bus: the newest of each kind, at most kMaxKinds. Older
/// ones are dropped, because they would be stale when the bus is back.
class OfflineValues {
  public:
    static constexpr std::size_t kMaxKinds = 64;

    /// A value that it replaces, or that has no place, is counted in `statistics`.
    void keep(const protocol::ParsedLine& line, Statistics& statistics);
    /// Takes out what was kept. Logs how many values were superseded.
    std::vector<protocol::ParsedLine> take(Effects& out);

  private:
    std::map<std::string, protocol::ParsedLine> newest_;
    std::uint64_t superseded_ = 0;
};

}  // namespace asip::agent
