// SPDX-License-Identifier: Apache-2.0
#include "agent/counts/statistics.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::agent {

namespace {

using nlohmann::json;

constexpr std::size_t kMaxCodes = 32;
constexpr int kOtherCode = -1;

std::string outcome_of(const bus::Reply& reply, bool proven) {
    using Status = bus::Reply::Status;
    const auto with_reason = [&](std::string word) {
        return reply.reason.empty() ? word : word + "/" + reply.reason;
    };
    switch (reply.status) {
        case Status::kOk:
            return proven ? "ok" : "unproven";
        case Status::kError:
            return "error";
        case Status::kTimeout:
            return with_reason("timeout");
        case Status::kRefused:
            return with_reason("refused");
    }
    return "refused";
}

double in_seconds(Duration duration) {
    return std::chrono::duration<double>(duration).count();
}

json optional_number(const std::optional<double>& number) {
    return number ? json(*number) : json();
}

json cumulative(const Histogram& histogram) {
    json buckets = json::array();
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < Histogram::kBounds.size(); ++i)
        buckets.push_back(below += histogram.counts()[i]);
    return buckets;
}

json line_counters(const session::BoardSession& session) {
    const auto& counters = session.counters();
    return {{"baud", session.baud()},
            {"lines_in", counters.lines_in},
            {"malformed", counters.garbage},
            {"checksum_errors", counters.checksum_errors},
            {"fence_timeouts", counters.fence_timeouts},
            {"unexplained_errors", counters.unexplained_errors},
            {"resets", counters.resets}};
}

json bus_counters(const mqtt::Counters& bus) {
    return {
        {"connects", bus.connects},       {"failures", bus.failures}, {"published", bus.published},
        {"received", bus.received},       {"rejected", bus.rejected}, {"dropped_values", bus.dropped_context},
        {"dropped_answers", bus.refused}, {"queued", bus.queued},     {"queued_bytes", bus.queued_bytes}};
}

}  // namespace

void Histogram::add(Duration took) {
    const double seconds = std::chrono::duration<double>(took).count();
    const auto bucket = std::lower_bound(kBounds.begin(), kBounds.end(), seconds) - kBounds.begin();
    ++counts_[static_cast<std::size_t>(bucket)];
    ++count_;
    sum_ += seconds;
}

std::optional<double> Histogram::quantile(double part) const {
    if (count_ == 0) return std::nullopt;
    const double wanted = part * static_cast<double>(count_);
    double below = 0;
    for (std::size_t i = 0; i < kBounds.size(); ++i) {
        const auto here = static_cast<double>(counts_[i]);
        if (here > 0 && below + here >= wanted) {
            const double from = i == 0 ? 0 : kBounds[i - 1];
            return from + (kBounds[i] - from) * (wanted - below) / here;
        }
        below += here;
    }
    return kBounds.back();
}

void Statistics::link_opened(Time now) {
    if (links_++ == 0) started_ = now;
}

void Statistics::sent(std::string_view bytes) {
    bytes_out_ += bytes.size();
    lines_out_ += static_cast<std::uint64_t>(std::count(bytes.begin(), bytes.end(), '\n'));
}

void Statistics::board_error(int code) {
    if (errors_.size() >= kMaxCodes && !errors_.contains(code)) code = kOtherCode;
    ++errors_[code];
}

void Statistics::answered(const bus::Reply& reply, bool proven, Duration took) {
    ++outcomes_[outcome_of(reply, proven)];
    using Status = bus::Reply::Status;
    if (!proven || (reply.status != Status::kOk && reply.status != Status::kError)) return;
    round_trips_.add(took);
    recent_round_trips_.add(took);
}

std::string Statistics::document(const Sources& sources, Time now) {
    if (!started_) started_ = now;
    json line = line_counters(sources.session);
    line["opened"] = links_;
    line["undecoded"] = sources.undecoded;
    line["bytes_in"] = bytes_in_;
    line["bytes_out"] = bytes_out_;
    line["lines_out"] = lines_out_;
    json bus = bus_counters(sources.bus);
    bus["superseded_values"] = superseded_;
    bus["forgotten_answers"] = sources.forgotten_answers;
    json errors = json::object();
    for (const auto& [code, count] : errors_)
        errors[code == kOtherCode ? "other" : std::to_string(code)] = count;
    json document{
        {"board", sources.board},
        {"session", sources.agent_session},
        {"number", ++documents_},
        {"uptime", in_seconds(now - *started_)},
        {"interval", in_seconds(now - last_.value_or(*started_))},
        {"line", std::move(line)},
        {"errors", std::move(errors)},
        {"commands", outcomes_},
        {"round_trip",
         {{"le", Histogram::kBounds},
          {"buckets", cumulative(round_trips_)},
          {"count", round_trips_.count()},
          {"sum", round_trips_.sum()},
          {"p50", optional_number(recent_round_trips_.quantile(.5))},
          {"p99", optional_number(recent_round_trips_.quantile(.99))}}},
        {"queue",
         {{"commands", sources.session.queued()}, {"bytes_in_flight", sources.session.bytes_in_flight()}}},
        {"holds", {{"active", sources.holds}, {"expired", expired_holds_}}},
        {"stops", stops_},
        {"bus", std::move(bus)}};
    if (const auto& periods = sources.periods; periods.on_demand())
        document["demand"] = {{"demanders", periods.demanders()},
                              {"rejected", periods.rejected()},
                              {"changes", periods.changes()},
                              {"periods", periods.periods()}};
    last_ = now;
    recent_round_trips_.clear();
    return model::dump_json(document);
}

}  // namespace asip::agent
