// SPDX-License-Identifier: Apache-2.0
#include "cli/events/top_model.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/duration.hpp"
#include "cli/commands/list.hpp"
#include "cli/text/sparkline.hpp"

namespace asip::cli {
namespace {

constexpr int kSlots = 10;
constexpr std::size_t kTrend = 12;

Cell age_cell(const std::optional<Time>& last, const std::optional<int>& period, Time now) {
    if (!last) return Cell("-", Colour::kDim);
    const auto age = now - *last;
    const bool stale = period && *period > 0 && age > 3 * std::chrono::milliseconds(*period);
    return Cell(text::duration_text(age), stale ? Colour::kRed : Colour::kNone);
}

}  // namespace

void TopModel::value(const std::string& board, const std::string& service, const std::string& payload,
                     Time now) {
    auto& one = boards_[board].services[service];
    const auto slot = window_ / kSlots;
    ++one.arrivals[Time((now.time_since_epoch() / slot) * slot)];
    one.last = now;
    one.payload = payload;
    sample(one, slot, now);
    while (!one.arrivals.empty() && one.arrivals.begin()->first + window_ <= now)
        one.arrivals.erase(one.arrivals.begin());
}

void TopModel::sample(Service& service, Duration slot, Time now) {
    if (!service.trend.empty() && now - service.sampled < slot) return;
    const auto value = model::parse_json(service.payload);
    const auto number = value ? first_number(*value) : std::nullopt;
    if (!number) return;
    service.sampled = now;
    service.trend.push_back(*number);
    if (service.trend.size() > kTrend) service.trend.pop_front();
}

void TopModel::error(const std::string& board, const std::string& service, Time now) {
    auto& one = boards_[board].services[service];
    ++one.errors;
    if (!one.last) one.last = now;
}

void TopModel::announced(const std::string& board, const std::string& service, std::optional<int> period) {
    boards_[board].services[service].period = period;
}

void TopModel::state(const std::string& board, const std::string& state) {
    boards_[board].state = state;
}

void TopModel::round_trip(const std::string& board, std::optional<std::chrono::duration<double>> took) {
    boards_[board].round_trip = took;
}

double TopModel::rate(Service& service, Time now) const {
    std::uint64_t count = 0;
    for (const auto& [slot, arrivals] : service.arrivals) {
        if (slot + window_ > now) count += arrivals;
    }
    return static_cast<double>(count) / std::chrono::duration<double>(window_).count();
}

std::vector<nlohmann::json> TopModel::records(Time now) {
    std::vector<nlohmann::json> result;
    for (auto& [name, board] : boards_) {
        nlohmann::json record{{"board", name}, {"state", board.state}};
        if (board.round_trip && *board.round_trip)
            record["round_trip_ms"] = (*board.round_trip)->count() * 1e3;
        if (board.services.empty()) result.push_back(record);
        for (auto& [service_name, service] : board.services) {
            auto one = record;
            one["service"] = service_name;
            one["rate"] = rate(service, now);
            one["errors"] = service.errors;
            if (service.last) one["age"] = std::chrono::duration<double>(now - *service.last).count();
            if (!service.payload.empty())
                one["last"] = model::parse_json(service.payload).value_or(nlohmann::json(service.payload));
            result.push_back(std::move(one));
        }
    }
    return result;
}

Table TopModel::table(Time now) {
    Table table({{"BOARD"},
                 {"STATE"},
                 {"TRIP", true},
                 {"SERVICE"},
                 {"RATE", true},
                 {"AGE", true},
                 {"ERRORS", true},
                 {"TREND"},
                 {"LAST", false, 10}});
    for (auto& [name, board] : boards_) {
        bool first = true;
        const auto trip = !board.round_trip   ? Cell("")
                          : *board.round_trip ? Cell(text::duration_text(**board.round_trip))
                                              : Cell("none", Colour::kRed);
        if (board.services.empty()) table.add({name, Cell(board.state, state_colour(board.state)), trip});
        for (auto& [service_name, service] : board.services) {
            const auto errors =
                Cell(std::to_string(service.errors), service.errors > 0 ? Colour::kRed : Colour::kNone);
            table.add({first ? name : "", first ? Cell(board.state, state_colour(board.state)) : Cell(""),
                       first ? trip : Cell(""), service_name, fmt::format("{:.1f}/s", rate(service, now)),
                       age_cell(service.last, service.period, now), errors,
                       sparkline(std::vector(service.trend.begin(), service.trend.end())), service.payload});
            first = false;
        }
    }
    return table;
}

}  // namespace asip::cli
