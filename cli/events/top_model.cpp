// SPDX-License-Identifier: Apache-2.0
#include "cli/events/top_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

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
    const auto heard = began_ ? std::clamp<Duration>(now - *began_, window_ / kSlots, window_) : window_;
    return static_cast<double>(count) / std::chrono::duration<double>(heard).count();
}

/// By which rows are sorted: the highest first.
double TopModel::key(const Row& row, Time now) const {
    constexpr double kNone = -1;
    switch (order_) {
        case Order::kRate:
            return row.service == nullptr ? kNone : rate(*row.service, now);
        case Order::kAge:
            return row.service == nullptr || !row.service->last
                       ? kNone
                       : std::chrono::duration<double>(now - *row.service->last).count();
        case Order::kErrors:
            return row.service == nullptr ? kNone : static_cast<double>(row.service->errors);
        case Order::kTrip:
            // Without an answer is the longest.
            if (!row.board->round_trip) return kNone;
            return *row.board->round_trip ? (**row.board->round_trip).count() : 1e9;
        case Order::kName:
            break;
    }
    return 0;
}

std::vector<TopModel::Row> TopModel::rows(Time now) {
    std::vector<Row> rows;
    for (auto& [name, board] : boards_) {
        if (board.services.empty()) rows.push_back({&name, &board});
        for (auto& [service_name, service] : board.services)
            rows.push_back({&name, &board, &service_name, &service});
    }
    if (order_ != Order::kName)
        std::stable_sort(rows.begin(), rows.end(),
                         [&](const Row& a, const Row& b) { return key(a, now) > key(b, now); });
    return rows;
}

std::vector<nlohmann::json> TopModel::records(Time now) {
    std::vector<nlohmann::json> result;
    for (auto& row : rows(now)) {
        nlohmann::json record{{"board", *row.board_name}, {"state", row.board->state}};
        if (row.board->round_trip && *row.board->round_trip)
            record["round_trip_ms"] = (*row.board->round_trip)->count() * 1e3;
        if (row.service != nullptr) {
            auto& service = *row.service;
            record["service"] = *row.service_name;
            record["rate"] = rate(service, now);
            record["errors"] = service.errors;
            if (service.last) record["age"] = std::chrono::duration<double>(now - *service.last).count();
            if (!service.payload.empty())
                record["last"] = model::parse_json(service.payload).value_or(nlohmann::json(service.payload));
        }
        result.push_back(std::move(record));
    }
    return result;
}

Table TopModel::table(Time now, std::size_t most) {
    Table table({{"BOARD"},
                 {"STATE"},
                 {"TRIP", true},
                 {"SERVICE"},
                 {"RATE", true},
                 {"AGE", true},
                 {"ERRORS", true},
                 {"TREND"},
                 {"LAST", false, 10}});
    auto all = rows(now);
    left_out_ = most != 0 && all.size() > most ? all.size() - most : 0;
    all.resize(all.size() - left_out_);
    const Board* above = nullptr;
    for (auto& row : all) {
        const auto& board = *row.board;
        const bool first = std::exchange(above, row.board) != row.board;
        const auto trip = !board.round_trip   ? Cell("")
                          : *board.round_trip ? Cell(text::duration_text(**board.round_trip))
                                              : Cell("none", Colour::kRed);
        const auto state = Cell(board.state, state_colour(board.state));
        if (row.service == nullptr) {
            table.add({*row.board_name, state, trip});
            continue;
        }
        auto& service = *row.service;
        const auto errors =
            Cell(std::to_string(service.errors), service.errors > 0 ? Colour::kRed : Colour::kNone);
        table.add({first ? *row.board_name : "", first ? state : Cell(""), first ? trip : Cell(""),
                   *row.service_name, fmt::format("{:.1f}/s", rate(service, now)),
                   age_cell(service.last, service.period, now), errors,
                   sparkline(std::vector(service.trend.begin(), service.trend.end())), service.payload});
    }
    return table;
}

}  // namespace asip::cli
