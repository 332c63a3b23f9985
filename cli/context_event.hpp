#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/topics.hpp"
#include "cli/target.hpp"
#include "cli/text/line_template.hpp"

namespace asip::cli {

/// One message of the context bus, as `asipctl subscribe` tells of it.
struct ContextEvent {
    enum class Kind { kValue, kError, kRaw };
    Kind kind = Kind::kValue;
    std::string board;
    std::string service;  ///< empty for raw lines
    std::string topic;
    std::string payload;
    bool retained = false;
    std::chrono::system_clock::time_point time{};
    std::optional<std::chrono::duration<double>> age;  ///< since the event before it of the same service

    std::string where() const { return service.empty() ? board : board + "/" + service; }
};

/// Nothing for a topic that is not of the context bus.
std::optional<ContextEvent> context_event(const bus::Topics& topics, const std::string& topic,
                                          std::string payload);

/// Filters that bring what `targets` ask for (raw lines, or decoded values and errors), none covered by
/// another.
std::vector<std::string> context_filters(const bus::Topics& topics, const std::vector<Target>& targets,
                                         bool raw);

/// `uno1/distance  {"distance":[42,118]}`, with time and age where asked for.
std::string event_text(const ContextEvent& event, bool with_time, bool with_age, bool colour);
/// One JSON object: time, board, service, event or error or line, age.
std::string event_json(const ContextEvent& event);
/// Value of a `--format` place: time, board, service, where, topic, kind, payload, age, or data.PATH into the
/// payload
/// (`data.distance.0`); empty where there is none.
std::string event_value(const ContextEvent& event, std::string_view name);
/// Fails with the names that there are when a template uses another.
Expected<void> check_event_template(const LineTemplate& line);

}  // namespace asip::cli
