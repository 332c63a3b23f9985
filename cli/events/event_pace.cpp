// SPDX-License-Identifier: Apache-2.0
#include "cli/events/event_pace.hpp"

#include <utility>

namespace asip::cli {

EventPace::EventPace(bool changes, double max_hz)
    : changes_(changes),
      least_(max_hz > 0 ? std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1 / max_hz))
                        : Duration::zero()) {}

std::optional<SeenEvent> EventPace::offer(SeenEvent event, Time now) {
    const bool all = !changes_ && least_ == Duration::zero();
    const bool counts =
        event.event.kind == ContextEvent::Kind::kError || event.event.kind == ContextEvent::Kind::kButton;
    if (all || counts) return event;
    auto& series = series_[event.event.topic + ' ' + event.decoded.what];
    if (changes_ && series.value == event.decoded.value) return std::nullopt;
    if (changes_) series.value = event.decoded.value;
    if (series.shown && now - *series.shown < least_) {
        if (!series.waiting) ++waiting_;
        series.waiting = std::move(event);
        return std::nullopt;
    }
    if (std::exchange(series.waiting, std::nullopt)) --waiting_;
    series.shown = now;
    return event;
}

std::vector<SeenEvent> EventPace::due(Time now) {
    std::vector<SeenEvent> result;
    if (waiting_ == 0) return result;
    for (auto& [key, series] : series_) {
        if (!series.waiting || now - *series.shown < least_) continue;
        result.push_back(std::move(*std::exchange(series.waiting, std::nullopt)));
        series.shown = now;
        --waiting_;
    }
    return result;
}

}  // namespace asip::cli
