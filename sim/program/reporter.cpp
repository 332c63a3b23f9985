// SPDX-License-Identifier: Apache-2.0
#include "sim/program/reporter.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace asip::sim {
namespace {

using nlohmann::ordered_json;

double seconds(SimTime time) {
    return static_cast<double>(time.count()) / 1e9;
}

/// Microseconds, in the digits that they need.
double rounded_seconds(SimTime time) {
    return static_cast<double>(time.count() / 1000) / 1e6;
}

}  // namespace

Reporter::Reporter(Format format, std::function<void(std::string_view)> write_line)
    : format_(format), write_line_(std::move(write_line)) {}

void Reporter::changed(const std::string& board, const Change& change) {
    if (format_ == Format::kText) {
        write(fmt::format("{} {:.6f} {} {}", board, seconds(change.time), change.part, change.value));
        return;
    }
    write(ordered_json{{"board", board},
                       {"time", rounded_seconds(change.time)},
                       {"part", change.part},
                       {"kind", change.kind},
                       {"value", change.value}}
              .dump());
}

void Reporter::happened(const std::string& board, SimTime time, std::string_view event,
                        const nlohmann::ordered_json& details) {
    if (format_ == Format::kText) {
        auto line = fmt::format("{} {:.6f} {}", board, seconds(time), event);
        for (const auto& [key, value] : details.items())
            line += fmt::format(" {}={}", key, value.is_string() ? value.get<std::string>() : value.dump());
        write(line);
        return;
    }
    ordered_json object{{"board", board}, {"time", rounded_seconds(time)}, {"event", event}};
    for (const auto& [key, value] : details.items())
        object[key] = value;
    write(object.dump());
}

void Reporter::write(const std::string& line) {
    const std::scoped_lock lock(mutex_);
    write_line_(line);
}

}  // namespace asip::sim
