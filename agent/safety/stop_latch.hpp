// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "agent/bridge/board.hpp"
#include "asip/expected.hpp"
#include "asip/model/description.hpp"
#include "asip/protocol/request.hpp"

namespace asip::agent {

/// A stop that holds: until the board is resumed, its agent sends nothing that may move it. It outlives
/// agent, machine and broker. Pure.
class StopLatch {
  public:
    /// What cannot be read counts as a stop.
    void load(Expected<std::optional<model::StopInfo>> kept);
    /// True: it was not stopped before. The first sender stays.
    bool stop(std::string by, std::string why, std::string since);
    /// True: it was stopped.
    bool resume();

    const std::optional<model::StopInfo>& stopped() const { return stopped_; }
    /// Whether the stop forbids this request: all but questions and periods of reports.
    bool holds(const session::ServiceTable& services, const protocol::Request& request) const;
    /// The sentence for the sender of a refused command.
    std::string why_refused(const std::string& board) const;

  private:
    std::optional<model::StopInfo> stopped_;
};

}  // namespace asip::agent
