// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asip/time.hpp"
#include "cli/events/decoded_event.hpp"

namespace asip::cli {

struct SeenEvent {
    ContextEvent event;
    DecodedEvent decoded;
};

/// Thins out reports: `changes` leaves out repetitions, `max_hz` bounds each kind (0: all). The newest comes
/// once its time has come. Errors and acts on buttons always pass. Pure.
class EventPace {
  public:
    EventPace(bool changes, double max_hz);

    /// Nothing: not now.
    std::optional<SeenEvent> offer(SeenEvent event, Time now);
    std::vector<SeenEvent> due(Time now);

  private:
    struct Series {
        std::optional<std::string> value;
        std::optional<Time> shown;
        std::optional<SeenEvent> waiting;
    };
    bool changes_;
    Duration least_;
    std::map<std::string, Series> series_;
    std::size_t waiting_ = 0;
};

}  // namespace asip::cli
