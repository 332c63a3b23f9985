// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "asip/mqtt/message.hpp"
#include "cli/events/context_event.hpp"

namespace asip::cli {

/// Each act once: only the agent tells a press from bouncing, on `$values`. The payload is {"io/2":"press"}.
class ButtonEvents {
  public:
    explicit ButtonEvents(const bus::Topics& topics) : topics_(topics) {}
    /// Past acts, and other messages, are passed over.
    std::vector<ContextEvent> take(const mqtt::Message& message);

  private:
    struct Acts {
        std::string session;
        std::uint64_t last = 0;
    };
    const bus::Topics& topics_;
    std::map<std::string, Acts> acts_;  // by board
};

}  // namespace asip::cli
