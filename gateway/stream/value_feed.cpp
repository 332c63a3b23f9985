#include "gateway/stream/value_feed.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"

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

std::string data_of(const ServiceValues& service, const ChannelValue& channel) {
    return R"({"board":")" + service.board + R"(","service":")" + service.service + R"(","at":")" +
           text::iso_time(channel.seen.wall) + R"(","value":)" + channel.json + "}";
}

}  // namespace

ValueFeed::ValueFeed(Values& values, Options options)
    : values_(&values),
      board_(std::move(options.board)),
      service_(std::move(options.service)),
      after_(std::move(options.after)),
      allowed_(std::move(options.allowed)) {
    if (options.max_hz > 0) {
        interval_ = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1 / options.max_hz));
    }
    if (after_) {
        phase_ = Phase::kLive;
        const auto* known = values.find(board_, service_);
        const bool epoch = after_->epoch == values.epoch();
        const std::uint64_t last = known == nullptr ? 0 : known->last;
        const bool kept = known == nullptr || after_->number >= last || known->point(after_->number + 1);
        if (!epoch || after_->number > last || !kept) {
            reset_reason_ = !epoch ? "another-epoch" : "past-gone";
            phase_ = Phase::kReset;
            after_.reset();
        }
    }
    values.add(*this);
}

ValueFeed::~ValueFeed() {
    if (values_ == nullptr) return;
    for (auto& [service, reading] : readings_) {
        auto& listeners = service->listeners;
        listeners.erase(std::remove(listeners.begin(), listeners.end(), this), listeners.end());
    }
    values_->remove(*this);
}

bool ValueFeed::exact() const {
    return board_.find_first_of("*?") == std::string::npos &&
           service_.find_first_of("*?") == std::string::npos;
}

void ValueFeed::appeared(ServiceValues& service) {
    if (!bus::matches_pattern(board_, service.board) || !bus::matches_pattern(service_, service.service))
        return;
    if (allowed_ && !allowed_(service.board, service.service)) return;
    auto& reading = readings_[&service];
    service.listeners.push_back(this);
    if (after_) {
        reading.sent = after_->number;
        queue(service, reading);
    } else {
        reading.sent = service.last;
        if (phase_ != Phase::kLive) snapshot_.push_back(&service);
    }
}

void ValueFeed::queue(ServiceValues& service, Reading& reading) {
    if (reading.queued || reading.sent == service.last) return;
    reading.queued = true;
    ready_.push_back(&service);
}

void ValueFeed::arrived(ServiceValues& service, Time now) {
    auto& reading = readings_[&service];
    if (!reading.queued) {
        queue(service, reading);
    } else if (interval_ == Duration{}) {
        return;  // it was woken for the one before
    }
    if (reading.not_before <= now) wake();
}

void ValueFeed::vanished(ServiceValues& service) {
    readings_.erase(&service);
    ready_.erase(std::remove(ready_.begin(), ready_.end(), &service), ready_.end());
    snapshot_.erase(std::remove(snapshot_.begin(), snapshot_.end(), &service), snapshot_.end());
}

void ValueFeed::tick(const Instant& now) {
    const auto due = [&](ServiceValues* service) { return readings_[service].not_before <= now.time; };
    if (interval_ != Duration{} && std::any_of(ready_.begin(), ready_.end(), due)) wake();
}

bool ValueFeed::next(StreamEvent& event, const Instant& now) {
    if (values_ == nullptr) return false;
    if (phase_ != Phase::kLive && out_.empty()) return next_snapshot(event, now);
    for (std::size_t turns = ready_.size(); out_.empty() && turns > 0; --turns) {
        auto* service = ready_.front();
        ready_.pop_front();
        auto& reading = readings_[service];
        reading.queued = false;
        if (reading.not_before > now.time) {
            reading.queued = true;
            ready_.push_back(service);
            continue;
        }
        read_service(*service, reading, now);
        queue(*service, reading);
    }
    if (out_.empty()) return false;
    event = std::move(out_.front());
    out_.pop_front();
    return true;
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
        readings_[service].sent = service->last;
        for (const auto& channel : service->channels) {
            auto data =
                with_member(data_of(*service, channel), "age", seconds_text(now.time - channel.seen.time));
            put(0, channel, std::move(data), false);
        }
        if (out_.empty()) return next_snapshot(event, now);
        event = std::move(out_.front());
        out_.pop_front();
        return true;
    }
    phase_ = Phase::kLive;
    std::uint64_t at = 0;
    if (exact()) {
        for (auto& [service, reading] : readings_)
            at = reading.sent;
    }
    event = {"snapshot-end", exact() ? Place{values_->epoch(), at}.text() : std::string(), "{}"};
    return true;
}

void ValueFeed::read_service(ServiceValues& service, Reading& reading, const Instant& now) {
    if (interval_ != Duration{}) reading.not_before = now.time + interval_;
    const std::uint64_t behind = service.last - reading.sent;
    const auto* point = service.point(reading.sent + 1);
    if (point == nullptr || (interval_ == Duration{} ? behind > kMaxBehind && !after_ : behind > 1)) {
        return newest_of_each(service, reading);
    }
    put(point->number, service.channels[point->channel], service.text(*point), true);
    reading.sent = point->number;
    if (reading.sent == service.last) after_.reset();  // resumed: from here on as everybody
}

// The last one carries the place: whoever is cut off before it resumes in front of all of them.
void ValueFeed::newest_of_each(ServiceValues& service, Reading& reading) {
    std::vector<const ChannelValue*> changed;
    for (const auto& channel : service.channels) {
        if (channel.number > reading.sent) changed.push_back(&channel);
    }
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
    out_.push_back({channel.error ? "error" : "value",
                    placed ? Place{values_->epoch(), number}.text() : std::string(), std::move(data)});
}

}  // namespace asip::gateway
