// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asip/time.hpp"
#include "cli/events/decoded_event.hpp"

namespace asip::cli {

/// An event with what it says.
struct SeenEvent {
    ContextEvent event;
    DecodedEvent decoded;
};

/// Thins out what boards report: `changes` leaves out a report that says the same as the one before it,
/// `max_hz` lets at most so many a second of each kind of report through (0: all). The newest is never lost:
/// what came too early is given out once its time has come. Errors pass always, and what is
/// done with buttons. Pure.
class EventPace {
  public:
    EventPace(bool changes, double max_hz);

    /// The event itself, if it is to be shown now.
    std::optional<SeenEvent> offer(SeenEvent event, Time now);
    /// Those whose time has come.
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
