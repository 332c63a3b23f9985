// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/values.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/bus/json_scanner.hpp"
#include "asip/model/json.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

constexpr std::size_t kPointBytes = sizeof(Point) + sizeof(void*) + 32;  // beside its text, as allocated
constexpr std::size_t kMaxMergedBytes = 8 * 1024;

// What was published, as compact JSON, and under which event it counts.
struct Report {
    std::string json;
    std::string event;
    bool part = false;  ///< of a map
};

constexpr std::size_t kMaxEventBytes = 64;
constexpr std::size_t kMaxPlainBytes = 256;

/// Whether a valid JSON value may stay as it was written: no white space, no escapes, no number with an
/// exponent (which may be beyond what a parser can hold).
bool stays_as_written(std::string_view value) {
    char before = 0;
    for (const char c : value) {
        if (static_cast<unsigned char>(c) <= ' ') return false;
        if (c == '\\' || ((c == 'e' || c == 'E') && before >= '0' && before <= '9')) return false;
        before = c;
    }
    return model::json_depth_within(value, model::JsonLimits{}.max_depth - 1);
}

/// A short report of one event, as most are: a tree of values costs ten times as much. Nothing: it is another
/// one, or no JSON.
std::optional<Report> plain_report(std::string_view payload) {
    if (payload.size() > kMaxPlainBytes) return std::nullopt;
    bus::JsonScanner scanner(payload);
    std::string_view event, value, another;
    if (!scanner.enter_object() || !scanner.next_member(event) || !scanner.value(value)) return std::nullopt;
    if (scanner.next_member(another) || !scanner.left() || !scanner.at_end()) return std::nullopt;
    constexpr std::size_t kAround = std::string_view(R"({"":})").size();
    if (payload.size() != event.size() + value.size() + kAround || event.size() > kMaxEventBytes ||
        event.find('\\') != event.npos || !stays_as_written(value))
        return std::nullopt;
    return Report{std::string(payload), std::string(event), !event.empty() && value.front() == '{'};
}

Report report_of(std::string_view payload) {
    if (auto plain = plain_report(payload)) return std::move(*plain);
    const auto parsed = model::parse_json(payload);
    if (!parsed) return {model::dump_json(json(std::string(payload))), {}, false};
    Report report{model::dump_json(*parsed), {}, false};
    if (!parsed->is_object() || parsed->size() != 1) return report;
    const auto first = parsed->begin();
    if (const auto& event = first.key(); event.size() <= kMaxEventBytes) report.event = event;
    report.part = !report.event.empty() && parsed->front().is_object();
    return report;
}

/// Adds what a part of a map names; false: they are not of one map.
bool add_part(json& all, const json& part) {
    const auto is_map = [](const json& value) {
        return value.is_object() && value.size() == 1 && value.front().is_object();
    };
    if (!is_map(all) || !is_map(part)) return false;
    all.front().update(part.front());
    return true;
}

}  // namespace

const std::string& ChannelValue::json() const {
    if (!parts_.empty()) put_together();
    return json_;
}

void ChannelValue::report(const std::string& text, bool part) {
    if (!part || (json_.empty() && parts_.empty())) {
        json_ = text;
        parts_.clear();
        return;
    }
    parts_.append(text).append("\n");
}

void ChannelValue::tidy() {
    if (parts_.size() > kMaxPartsBytes) put_together();
}

void ChannelValue::put_together() const {
    auto all = nlohmann::json::parse(json_, nullptr, false);
    std::size_t bytes = json_.size();
    std::string_view rest = parts_;
    while (!rest.empty()) {
        const auto text = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(text.size() + 1);
        auto part = nlohmann::json::parse(text, nullptr, false);
        const bool added = add_part(all, part);
        bytes += text.size();  // at most: it may replace what is there
        if (added && bytes > kMaxMergedBytes) bytes = model::dump_json(all).size();
        if (added && bytes <= kMaxMergedBytes) continue;
        all = std::move(part);
        bytes = text.size();
    }
    json_ = model::dump_json(all);
    parts_.clear();
}

const Point* ServiceValues::point(std::uint64_t number) const {
    if (points.empty() || number < points.front().number || number > points.back().number) return nullptr;
    return &points[static_cast<std::size_t>(number - points.front().number)];
}

const std::string& ServiceValues::text(const Point& point) const {
    if (cached_number_ == point.number) return cached_;
    cached_number_ = point.number;
    cached_.clear();
    cached_.append(R"({"board":")").append(board).append(R"(","service":")").append(service);
    cached_.append(R"(","at":")").append(text::iso_time(point.seen.wall)).append(R"(","value":)");
    cached_.append(point.json).append("}");
    return cached_;
}

Values::Values(std::string epoch, ValueLimits limits) : epoch_(std::move(epoch)), limits_(limits) {}

Values::~Values() {
    for (auto* feed : feeds_)
        feed->values_ = nullptr;
}

ServiceValues* Values::make(std::string_view board, std::string_view service) {
    if (auto* found = known(board, service)) return found;
    if (services_ >= limits_.services) return nullptr;
    auto& of_board = boards_[std::string(board)];
    if (of_board.size() >= limits_.of_board) return nullptr;
    auto* result = of_board.emplace_back(std::make_unique<ServiceValues>()).get();
    result->board = board;
    result->service = service;
    ++services_;
    for (auto* feed : feeds_)
        feed->appeared(*result);
    return result;
}

void Values::value(std::string_view board, std::string_view service, std::string_view payload, bool error,
                   const Instant& now) {
    ++received_;
    auto* values = make(board, service);
    if (values == nullptr) return;
    auto report = report_of(payload);
    auto& channels = values->channels;
    auto channel = std::find_if(channels.begin(), channels.end(), [&](const ChannelValue& each) {
        return each.error == error && (error || each.event == report.event);
    });
    if (channel == channels.end()) {
        if (channels.size() >= limits_.channels) return;
        channel = channels.emplace(channels.end());
        channel->error = error;
        if (!error) channel->event = report.event;
    }
    const auto index = static_cast<std::uint32_t>(channel - channels.begin());
    Point point{++values->last, now, index, std::move(report.json)};
    channel->number = point.number;
    channel->seen = now;
    channel->report(point.json, !error && report.part);
    bytes_ += kPointBytes + point.json.size();
    values->points.push_back(std::move(point));
    arrivals_.push_back(values);
    if (values->points.size() > limits_.points) {
        drop_front(*values);
        ++values->dropped_ahead;
    }
    while (bytes_ > limits_.bytes && !arrivals_.empty())
        drop_oldest();
    for (auto* feed : values->listeners)
        feed->arrived(*values, now.time);
    values->channels[index].tidy();  // behind the readers: it takes longer than they do
}

void Values::drop_front(ServiceValues& service) {
    bytes_ -= kPointBytes + service.points.front().json.size();
    service.points.pop_front();
}

void Values::drop_oldest() {
    auto* service = arrivals_.front();
    arrivals_.pop_front();
    if (service->dropped_ahead > 0) {
        --service->dropped_ahead;
    } else {
        drop_front(*service);
    }
}

void Values::expire(const Instant& now) {
    while (!arrivals_.empty()) {
        auto* service = arrivals_.front();
        if (service->dropped_ahead == 0 && now.time - service->points.front().seen.time <= limits_.age) break;
        drop_oldest();
    }
}

void Values::forget(std::string_view board) {
    const auto found = boards_.find(board);
    if (found == boards_.end()) return;
    const auto gone = std::move(found->second);
    boards_.erase(found);
    services_ -= gone.size();
    const auto is_gone = [&](ServiceValues* each) {
        return std::any_of(gone.begin(), gone.end(),
                           [&](const auto& service) { return service.get() == each; });
    };
    arrivals_.erase(std::remove_if(arrivals_.begin(), arrivals_.end(), is_gone), arrivals_.end());
    for (const auto& service : gone) {
        for (const auto& point : service->points)
            bytes_ -= kPointBytes + point.json.size();
        for (auto* feed : service->listeners)
            feed->vanished(*service);
    }
}

const ServiceValues* Values::find(std::string_view board, std::string_view service) const {
    return known(board, service);
}

ServiceValues* Values::known(std::string_view board, std::string_view service) const {
    const auto found = boards_.find(board);
    if (found == boards_.end()) return nullptr;
    for (const auto& each : found->second)
        if (each->service == service) return each.get();
    return nullptr;
}

void Values::add(ValueFeed& feed) {
    feeds_.push_back(&feed);
    if (feed.exact()) {
        if (auto* service = known(feed.board_, feed.service_)) feed.appeared(*service);
        return;
    }
    for (auto& [board, services] : boards_) {
        for (auto& service : services)
            feed.appeared(*service);
    }
}

void Values::remove(ValueFeed& feed) {
    feeds_.erase(std::remove(feeds_.begin(), feeds_.end(), &feed), feeds_.end());
    const auto release = [&](ServiceValues& service) { std::erase(service.listeners, &feed); };
    if (feed.exact()) {
        if (auto* service = known(feed.board_, feed.service_)) release(*service);
        return;
    }
    for (auto& [board, services] : boards_) {
        for (auto& service : services)
            release(*service);
    }
}

}  // namespace asip::gateway
