// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/value_feed.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"
#include "asip/bus/request/line_service.hpp"

namespace asip::gateway {
namespace {

std::string with_member(std::string object, std::string_view name, const std::string& value) {
    object.pop_back();
    return object.append(",\"").append(name).append("\":").append(value).append("}");
}

std::string seconds_text(Duration duration) {
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
    std::string text = std::to_string(ms % 1000);
    return std::to_string(ms / 1000) + "." + std::string(3 - text.size(), '0') + text;
}

std::size_t bytes_of(const StreamEvent& event) {
    return sizeof event + event.place.size() + event.data.size();
}

std::string data_of(const ServiceValues& service, const ChannelValue& channel) {
    return R"({"board":")" + service.board + R"(","service":")" + service.service + R"(","at":")" +
           text::iso_time(channel.seen.wall) + R"(","value":)" + channel.json() + cut_member(channel.cut) +
           "}";
}

}  // namespace

ValueFeed::ValueFeed(Values& values, Options options)
    : values_(&values),
      board_(std::move(options.board)),
      service_(std::move(options.service)),
      after_(std::move(options.after)),
      after_each_(std::move(options.after_each)),
      allowed_(std::move(options.allowed)),
      demand_(std::move(options.demand)),
      part_(std::move(options.part)) {
    if (!part_.set(kBytes + options.demands * kBytesOfDemand)) too_much();
    if (options.max_hz > 0)
        interval_ = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1 / options.max_hz));
    if (after_) resume_one();
    if (after_each_) resume_each();
    values.add(*this);
    after_each_.reset();
}

void ValueFeed::resume_one() {
    phase_ = Phase::kLive;
    const auto* known = values_->find(board_, service_);
    const bool epoch = after_->epoch == values_->epoch();
    const std::uint64_t last = known == nullptr ? 0 : known->last;
    const bool kept = known == nullptr || after_->number >= last || known->point(after_->number + 1);
    if (epoch && after_->number <= last && kept) return;
    reset_reason_ = epoch ? "past-gone" : "another-epoch";
    phase_ = Phase::kReset;
    after_.reset();
}

void ValueFeed::resume_each() {
    if (after_each_->epoch != values_->epoch()) {
        reset_reason_ = "another-epoch";
        phase_ = Phase::kReset;
        after_each_.reset();
    } else if (after_each_->others) {
        phase_ = Phase::kLive;
    }
}

ValueFeed::~ValueFeed() {
    if (values_ != nullptr) values_->remove(*this);
}

bool ValueFeed::exact() const {
    const auto one = [](const std::string& text) {
        return !text.empty() && text.find_first_of("*?") == std::string::npos;  // an empty pattern is any
    };
    return one(board_) && one(service_);
}

std::optional<std::uint64_t> ValueFeed::place_of(const ServiceValues& service) const {
    if (after_) return after_->number;
    if (!after_each_) return std::nullopt;
    const auto named = after_each_->services.find(service.board + "/" + service.service);
    return named == after_each_->services.end() ? after_each_->others : named->second;
}

void ValueFeed::appeared(ServiceValues& service) {
    if (!bus::matches_pattern(board_, service.board) || !bus::matches_pattern(service_, service.service))
        return;
    if (service.service == bus::kLineService && service_ != service.service) return;
    if (allowed_ && !allowed_(service.board, service.service)) return;
    if (!fault_.empty()) return;
    if (!part_.add(kBytesOfService)) return too_much();
    service.listeners.push_back(this);
    if (service.last == 0) return;
    // A larger number is of a board that was forgotten and came back.
    if (const auto place = place_of(service); place && *place <= service.last) {
        if (*place == service.last) return;
        auto& reading = readings_[&service];
        reading.sent = *place;
        reading.resumed = true;
        queue(service, reading);
    } else if (phase_ != Phase::kLive || place) {
        snapshot_.push_back(&service);
        if (phase_ == Phase::kLive) phase_ = Phase::kSnapshot;
    }
}

void ValueFeed::too_much() {
    fault_ = kTooMuchKept;
    wake();
}

void ValueFeed::queue(ServiceValues& service, Reading& reading) {
    if (reading.queued || reading.sent == service.last) return;
    reading.queued = true;
    ready_.push_back(&service);
}

void ValueFeed::arrived(ServiceValues& service, Time now) {
    const auto [found, is_new] = readings_.try_emplace(&service);
    auto& reading = found->second;
    if (is_new) reading.sent = service.last - 1;
    if (!reading.queued)
        queue(service, reading);
    else if (interval_ == Duration{})
        return;  // it was woken for the one before
    if (reading.not_before <= now) wake();
}

void ValueFeed::vanished(ServiceValues& service) {
    part_.give_back(kBytesOfService);
    readings_.erase(&service);
    ready_.erase(std::remove(ready_.begin(), ready_.end(), &service), ready_.end());
    snapshot_.erase(std::remove(snapshot_.begin(), snapshot_.end(), &service), snapshot_.end());
}

void ValueFeed::tick(const Instant& now) {
    const auto due = [&](ServiceValues* service) { return readings_[service].not_before <= now.time; };
    if (interval_ != Duration{} && std::any_of(ready_.begin(), ready_.end(), due)) wake();
}

bool ValueFeed::next(StreamEvent& event, const Instant& now) {
    if (values_ == nullptr || !fault_.empty()) return false;
    if (phase_ != Phase::kLive && out_.empty()) return next_snapshot(event, now);
    for (std::size_t turns = ready_.size(); out_.empty() && turns > 0; --turns)
        read_next(now);
    if (out_.empty()) return false;
    event = taken();
    return true;
}

StreamEvent ValueFeed::taken() {
    auto event = std::move(out_.front());
    out_.pop_front();
    part_.give_back(std::min(part_.bytes(), bytes_of(event)));
    return event;
}

void ValueFeed::read_next(const Instant& now) {
    auto* service = ready_.front();
    ready_.pop_front();
    auto& reading = readings_[service];
    if (reading.not_before > now.time) return ready_.push_back(service);
    reading.queued = false;
    read_service(*service, reading, now);
    queue(*service, reading);
    if (!reading.queued && interval_ == Duration{}) readings_.erase(service);
}

bool ValueFeed::next_snapshot(StreamEvent& event, const Instant& now) {
    if (phase_ == Phase::kReset) {
        phase_ = Phase::kSnapshot;
        event = {"reset", {}, R"({"reason":")" + std::string(reset_reason_) + "\"}"};
        return true;
    }
    if (!snapshot_.empty()) {
        auto* service = snapshot_.front();
        snapshot_.pop_front();
        if (const auto waits = readings_.find(service); waits != readings_.end())
            waits->second.sent = service->last;
        snapshot_number_ = service->last;
        for (const auto& channel : service->channels) {
            auto data =
                with_member(data_of(*service, channel), "age", seconds_text(now.time - channel.seen.time));
            put(service->last, channel, std::move(data), !exact() && &channel == &service->channels.back());
        }
        if (out_.empty()) return fault_.empty() && next_snapshot(event, now);
        event = taken();
        return true;
    }
    phase_ = Phase::kLive;
    // For a pattern: the place of services that report for the first time from now on.
    event = {"snapshot-end", Place{values_->epoch(), exact() ? snapshot_number_ : 0}.text(), "{}"};
    return true;
}

void ValueFeed::read_service(ServiceValues& service, Reading& reading, const Instant& now) {
    if (interval_ != Duration{}) reading.not_before = now.time + interval_;
    const std::uint64_t behind = service.last - reading.sent;
    const auto* point = service.point(reading.sent + 1);
    if (point == nullptr || (interval_ == Duration{} ? behind > kMaxBehind && !reading.resumed : behind > 1))
        return newest_of_each(service, reading);
    put(point->number, service.channels[point->channel], service.text(*point), true);
    reading.sent = point->number;
    if (reading.sent == service.last) reading.resumed = false;
}

// The last one carries the place: a client that is cut off before it resumes in front of all of them.
void ValueFeed::newest_of_each(ServiceValues& service, Reading& reading) {
    std::vector<const ChannelValue*> changed;
    for (const auto& channel : service.channels)
        if (channel.number > reading.sent) changed.push_back(&channel);
    std::sort(changed.begin(), changed.end(), [](auto* a, auto* b) { return a->number < b->number; });
    const std::uint64_t left_out = service.last - reading.sent - changed.size();
    for (const auto* channel : changed) {
        const bool last = channel == changed.back();
        auto data = data_of(service, *channel);
        if (last && left_out > 0) data = with_member(std::move(data), "left_out", std::to_string(left_out));
        put(channel->number, *channel, std::move(data), last);
    }
    left_out_ += left_out;
    values_->count_left_out(left_out);
    reading.sent = service.last;
}

void ValueFeed::put(std::uint64_t number, const ChannelValue& channel, std::string data, bool placed) {
    StreamEvent event{channel.error ? "error" : "value",
                      placed ? Place{values_->epoch(), number}.text() : std::string(), std::move(data)};
    if (!part_.add(bytes_of(event))) return too_much();
    out_.push_back(std::move(event));
}

}  // namespace asip::gateway
