// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gateway/instant.hpp"

namespace asip::gateway {

/// One value that a service reported, or an error.
struct Point {
    std::uint64_t number = 0;  ///< of its service, from 1, without a gap
    Instant seen;
    std::uint32_t channel = 0;  ///< index into ServiceValues::channels
    std::string json;           ///< what was published; what is not JSON as a JSON string
};

/// The last value of one event of a service.
struct ChannelValue {
    std::string event;  ///< "distance"; empty: what was published is no object with one member
    bool error = false;
    std::uint64_t number = 0;  ///< of the last point
    Instant seen;

    /// As published; where each report holds a part of a map (`{"digital":{"2":1}}`), all parts together.
    const std::string& json() const;
    /// `part`: of a map.
    void report(const std::string& text, bool part);
    /// Call some time after each report: keeps what json() puts together short.
    void tidy();

  private:
    /// Until somebody asks: a reader that keeps up never does.
    static constexpr std::size_t kMaxPartsBytes = 512;
    void put_together() const;

    mutable std::string json_;
    mutable std::string parts_;  // reported behind json_, each with a line end
};

/// A queue in one block: most services have few points, for which std::deque would take ten times as much.
class Points {
  public:
    bool empty() const { return first_ == points_.size(); }
    std::size_t size() const { return points_.size() - first_; }
    const Point& operator[](std::size_t i) const { return points_[first_ + i]; }
    const Point& front() const { return points_[first_]; }
    const Point& back() const { return points_.back(); }
    auto begin() const { return points_.begin() + static_cast<std::ptrdiff_t>(first_); }
    auto end() const { return points_.end(); }

    void push_back(Point point) {
        if (points_.size() == points_.capacity() && first_ >= points_.size() / 2) close_up();
        points_.push_back(std::move(point));
    }
    void pop_front() {
        points_[first_++].json = {};
        if (empty()) points_ = std::vector<Point>(), first_ = 0;
    }

  private:
    void close_up() {
        points_.erase(points_.begin(), begin());
        first_ = 0;
    }

    std::vector<Point> points_;  // those before first_ are gone
    std::size_t first_ = 0;
};

class ValueFeed;

/// What one service reported lately.
struct ServiceValues {
    std::string board;
    std::string service;
    std::uint64_t last = 0;  ///< number of the newest point, 0: none yet
    Points points;           ///< the newest, consecutive numbers
    std::vector<ChannelValue> channels;
    std::vector<ValueFeed*> listeners;
    std::size_t dropped_ahead = 0;  ///< entries of the order of arrival that are gone already

    /// Null: it is not kept any more, or not yet there.
    const Point* point(std::uint64_t number) const;
    /// `{"board":..,"service":..,"at":..,"value":..}`, cached for the newest.
    const std::string& text(const Point& point) const;

  private:
    mutable std::uint64_t cached_number_ = 0;
    mutable std::string cached_;
};

struct ValueLimits {
    std::size_t points = 1200;                  ///< of a service
    Duration age = std::chrono::minutes(10);    ///< of a point
    std::size_t bytes = std::size_t{32} << 20;  ///< of all points together
    std::size_t services = 200'000;             ///< beyond these a service's values are not kept
    std::size_t of_board = 256;                 ///< the same of one board's services
    std::size_t channels = 16;                  ///< different events of a service
};

/// The last value of each service and a ring of recent ones. Pure: messages and time in. Values of a service
/// are kept until its board is forgotten; points give way to newer ones, the oldest of all first.
class Values {
  public:
    explicit Values(std::string epoch, ValueLimits limits = {});
    ~Values();
    Values(const Values&) = delete;
    Values& operator=(const Values&) = delete;

    const std::string& epoch() const { return epoch_; }
    void value(std::string_view board, std::string_view service, std::string_view payload, bool error,
               const Instant& now);
    void forget(std::string_view board);
    void expire(const Instant& now);
    /// Null: nothing was heard from it.
    const ServiceValues* find(std::string_view board, std::string_view service) const;

    std::size_t services() const { return services_; }
    std::size_t points() const { return arrivals_.size(); }
    std::size_t bytes() const { return bytes_; }
    std::uint64_t received() const { return received_; }
    std::uint64_t left_out() const { return left_out_; }
    void count_left_out(std::uint64_t values) { left_out_ += values; }

  private:
    friend class ValueFeed;
    ServiceValues* make(std::string_view board, std::string_view service);
    ServiceValues* known(std::string_view board, std::string_view service) const;
    void drop_front(ServiceValues& service);
    void drop_oldest();
    void add(ValueFeed& feed);
    void remove(ValueFeed& feed);

    std::string epoch_;
    ValueLimits limits_;
    std::map<std::string, std::vector<std::unique_ptr<ServiceValues>>, std::less<>> boards_;
    std::size_t services_ = 0;
    std::deque<ServiceValues*> arrivals_;  // of each point that is kept, in order; see dropped_ahead
    std::vector<ValueFeed*> feeds_;
    std::size_t bytes_ = 0;
    std::uint64_t received_ = 0;
    std::uint64_t left_out_ = 0;
};

}  // namespace asip::gateway
