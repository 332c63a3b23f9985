// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/model/description.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {

/// As `asipctl subscribe` prints it.
struct ContextEvent {
    enum class Kind { kValue, kError, kRaw, kButton };
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

/// Nothing: another topic.
std::optional<ContextEvent> context_event(const bus::Topics& topics, const std::string& topic,
                                          std::string payload);

/// For what `targets` ask for, none covered by another.
std::vector<std::string> context_filters(const bus::Topics& topics, const std::vector<Target>& targets,
                                         bool raw);

/// Raw lines of one service, and a service by its letter, need the board's description.
bool needs_description(const Target& target, bool raw);

/// A raw line is of the service of its first letter (`@D,`); `description`: null: a letter stands for itself.
bool is_wanted(const ContextEvent& event, const std::vector<Target>& targets,
               const model::Description* description);

/// `uno1/distance  TEXT`, with time and age where asked for.
std::string event_text(const ContextEvent& event, const std::string& text, bool with_time, bool with_age,
                       bool colour);
/// `SERVICE  VALUE`.
std::string event_header(bool with_time, bool with_age, bool colour);
/// time, board, service; event, error, line or button; and age (seconds) where known.
nlohmann::json event_json(const ContextEvent& event);
/// Members of ContextEvent, and `data`, the payload.
std::vector<std::string> event_fields();
/// `data.distance.0` leads into the payload. May be empty.
std::string event_value(const ContextEvent& event, std::string_view name);

}  // namespace asip::cli
