// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/values.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/model/json.hpp"
#include "gateway/stream/value_feed.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxMergedBytes = 8 * 1024;
constexpr std::size_t kServiceBytes = sizeof(ServiceValues) + 128;  // with its place in what holds it

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

// Too long to be kept: only its event counts, if it is one of an event.
Report long_report(std::string_view payload) {
    Report report;
    bus::JsonScanner scanner(payload);
    std::string_view event, value, another;
    if (scanner.enter_object() && scanner.next_member(event) && scanner.value(value) &&
        !scanner.next_member(another) && scanner.left() && scanner.at_end() &&
        event.size() <= kMaxEventBytes && event.find('\\') == event.npos)
        report.event = event;
    return report;
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

// At the end of a character of UTF-8.
std::string_view beginning(std::string_view text, std::size_t max) {
    std::size_t end = std::min(text.size(), max);
    while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
        --end;
    return text.substr(0, end);
}

/// A report that is longer than `max` is cut to its beginning. Returns how many bytes were published;
/// 0: it is whole.
std::size_t cut_to(std::size_t max, std::string_view payload, Report& report) {
    if (!report.json.empty() && report.json.size() <= max) return 0;
    // As JSON it may be longer than it was.
    for (std::size_t length = max; report.json.empty() || report.json.size() > max; length /= 2)
        report.json = model::dump_json(json(std::string(beginning(payload, length))));
    report.json.shrink_to_fit();
    report.part = false;
    return payload.size();
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

std::string cut_member(std::size_t cut) {
    return cut == 0 ? std::string() : ",\"cut\":" + std::to_string(cut);
}

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
    cached_.append(point.json).append(cut_member(point.cut)).append("}");
    return cached_;
}

Values::~Values() {
    for (auto* feed : feeds_)
        feed->values_ = nullptr;
}

ServiceValues* Values::make(std::string_view board, std::string_view service, Board*& of) {
    const auto found = boards_.find(board);
    if (found != boards_.end()) {
        of = &found->second;
        if (auto* known = of->find(service)) return known;
        if (of->services.size() >= limits_.of_board) return nullptr;
    }
    if (services_ >= limits_.services || last_bytes_ >= 2 * limits_.last_bytes) return nullptr;
    if (found == boards_.end()) of = &boards_[std::string(board)];
    auto* result = of->services.emplace_back(std::make_unique<ServiceValues>()).get();
    result->board = board;
    result->service = service;
    ++services_;
    for (auto* feed : feeds_)
        feed->appeared(*result);
    return result;
}

void Values::count_last(Board& board, ServiceValues& service) {
    std::size_t bytes = kServiceBytes + heap_bytes(service.board) + heap_bytes(service.service) +
                        service.channels.capacity() * sizeof(ChannelValue);
    for (const auto& channel : service.channels)
        bytes += channel.bytes();
    const auto change = [&](std::size_t& sum) { sum = sum - service.last_bytes + bytes; };
    change(board.last_bytes);
    change(last_bytes_);
    service.last_bytes = bytes;
}

// How long a value of so many bytes may be.
std::size_t Values::room_for(const Board& board, std::size_t bytes) const {
    const bool fits =
        board.last_bytes + bytes <= limits_.board_last_bytes && last_bytes_ + bytes <= limits_.last_bytes;
    return fits ? limits_.value : std::min(kShortValue, limits_.value);
}

void Values::value(std::string_view board, std::string_view service, std::string_view payload, bool error,
                   const Instant& now) {
    ++received_;
    Board* of = nullptr;
    auto* values = make(board, service, of);
    if (values == nullptr) return;
    auto& of_board = *of;
    auto report = payload.size() > limits_.value ? long_report(payload) : report_of(payload);
    auto& channels = values->channels;
    auto channel = std::find_if(channels.begin(), channels.end(), [&](const ChannelValue& each) {
        return each.error == error && (error || each.event == report.event);
    });
    if (channel == channels.end()) {
        if (channels.size() >= limits_.channels || last_bytes_ >= 2 * limits_.last_bytes) return;
        channel = channels.emplace(channels.end());
        channel->error = error;
        if (!error) channel->event = report.event;
    }
    const auto cut = cut_to(room_for(of_board, std::min(payload.size(), limits_.value)), payload, report);
    const auto index = static_cast<std::uint32_t>(channel - channels.begin());
    Point point{++values->last, now, index, std::move(report.json), cut};
    channel->number = point.number;
    channel->seen = now;
    // Parts of before are not put together with those of now.
    const bool outdated = std::exchange(channel->outdated, false);
    const bool part = !error && report.part && !outdated;
    channel->cut = cut;
    channel->report(point.json, part);
    bytes_ += heap_bytes(point.json);
    bytes_ -= values->points.block_bytes();
    values->points.push_back(std::move(point));
    bytes_ += values->points.block_bytes();
    arrivals_.push_back(values);
    if (values->points.size() > limits_.points) {
        drop_front(*values);
        ++values->dropped_ahead;
        ++gone_arrivals_;
        tidy_arrivals();
    }
    while (bytes() > limits_.bytes && !arrivals_.empty())
        drop_oldest();
    for (auto* feed : values->listeners)
        feed->arrived(*values, now.time);
    values->channels[index].tidy();  // behind the readers: it takes longer than they do
    count_last(of_board, *values);
}

void Values::drop_front(ServiceValues& service) {
    bytes_ -= heap_bytes(service.points.front().json) + service.points.block_bytes();
    service.points.pop_front();
    bytes_ += service.points.block_bytes();
}

void Values::drop_oldest() {
    auto* service = arrivals_.front();
    arrivals_.pop_front();
    if (service->dropped_ahead > 0) {
        --service->dropped_ahead;
        --gone_arrivals_;
    } else {
        drop_front(*service);
    }
}

// The points of a service that reports much go before their entries do, which must not pile up. The first
// entries of a service are those of what is gone.
void Values::tidy_arrivals() {
    constexpr std::size_t kFew = 1000;
    if (gone_arrivals_ < kFew || gone_arrivals_ < arrivals_.size() / 2) return;
    std::erase_if(arrivals_, [](ServiceValues* service) {
        if (service->dropped_ahead == 0) return false;
        --service->dropped_ahead;
        return true;
    });
    arrivals_.shrink_to_fit();
    gone_arrivals_ = 0;
}

void Values::expire(const Instant& now) {
    while (!arrivals_.empty()) {
        auto* service = arrivals_.front();
        if (service->dropped_ahead == 0 && now.time - service->points.front().seen.time <= limits_.age) break;
        drop_oldest();
    }
}

void Values::begin_anew(std::string_view board) {
    const auto found = boards_.find(board);
    if (found == boards_.end()) return;
    for (const auto& service : found->second.services)
        for (auto& channel : service->channels)
            channel.outdated = true;
}

void Values::forget(std::string_view board) {
    const auto found = boards_.find(board);
    if (found == boards_.end()) return;
    const auto gone = std::move(found->second);
    boards_.erase(found);
    services_ -= gone.services.size();
    last_bytes_ -= gone.last_bytes;
    std::erase_if(arrivals_, [&](ServiceValues* each) { return each->board == board; });
    for (const auto& service : gone.services) {
        gone_arrivals_ -= service->dropped_ahead;
        bytes_ -= service->points.block_bytes();
        for (const auto& point : service->points)
            bytes_ -= heap_bytes(point.json);
        for (auto* feed : service->listeners)
            feed->vanished(*service);
    }
}

ServiceValues* Values::known(std::string_view board, std::string_view service) const {
    const auto found = boards_.find(board);
    return found == boards_.end() ? nullptr : found->second.find(service);
}

void Values::add(ValueFeed& feed) {
    feeds_.push_back(&feed);
    if (feed.exact()) {
        if (auto* service = known(feed.board_, feed.service_)) feed.appeared(*service);
        return;
    }
    for (auto& [board, of] : boards_)
        for (auto& service : of.services)
            feed.appeared(*service);
}

void Values::remove(ValueFeed& feed) {
    std::erase(feeds_, &feed);
    if (feed.exact()) {
        if (auto* service = known(feed.board_, feed.service_)) std::erase(service->listeners, &feed);
        return;
    }
    for (auto& [board, of_board] : boards_)
        for (auto& service : of_board.services)
            std::erase(service->listeners, &feed);
}

}  // namespace asip::gateway
