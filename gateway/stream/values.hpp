// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gateway/instant.hpp"

namespace asip::gateway {

/// On the heap.
inline std::size_t heap_bytes(const std::string& text) {
    constexpr std::size_t kInside = 15;  // that stand in the object itself
    constexpr std::size_t kAround = 16;  // of the allocator
    return text.capacity() > kInside ? text.capacity() + kAround : 0;
}

/// A value that a service reported, or an error.
struct Point {
    std::uint64_t number = 0;  ///< of its service, from 1, without a gap
    Instant seen;
    std::uint32_t channel = 0;  ///< index into ServiceValues::channels
    /// What is not JSON becomes a JSON string. A payload that is too long is cut to its beginning; `cut` is
    /// its full length.
    std::string json;
    std::size_t cut = 0;
};

struct ChannelValue {
    std::string event;  ///< "distance"; empty: what was published is no object with one member
    bool error = false;
    bool outdated = false;     ///< the board began anew since, and says how it is
    std::uint64_t number = 0;  ///< of the last point
    Instant seen;
    std::size_t cut = 0;  ///< as Point::cut

    /// As published; where reports hold parts of a map (`{"digital":{"2":1}}`), all together.
    const std::string& json() const;
    std::size_t bytes() const { return heap_bytes(event) + heap_bytes(json_) + heap_bytes(parts_); }
    void report(const std::string& text, bool part);
    /// Keeps json() short. Call some time after each report.
    void tidy();

  private:
    /// Until a reader asks.
    static constexpr std::size_t kMaxPartsBytes = 512;
    void put_together() const;

    mutable std::string json_;
    mutable std::string parts_;  // reported behind json_, each with a line end
};

/// A queue in one block, since std::deque would take ten times as much for few points.
class Points {
  public:
    bool empty() const { return first_ == points_.size(); }
    std::size_t size() const { return points_.size() - first_; }
    /// The block's bytes; the texts aside.
    std::size_t block_bytes() const { return points_.capacity() * sizeof(Point); }
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
        if (size() <= points_.capacity() / 4) shrink();
    }

  private:
    void close_up() {
        points_.erase(points_.begin(), begin());
        first_ = 0;
    }
    // Few points do not keep the block of many.
    void shrink() {
        std::vector<Point> fewer;
        fewer.reserve(2 * size());
        std::move(points_.begin() + static_cast<std::ptrdiff_t>(first_), points_.end(),
                  std::back_inserter(fewer));
        points_ = std::move(fewer);
        first_ = 0;
    }

    std::vector<Point> points_;  // those before first_ are gone
    std::size_t first_ = 0;
};

/// `,"cut":100000` where only the beginning is kept; empty: it is whole.
std::string cut_member(std::size_t cut);

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
    std::size_t last_bytes = 0;     ///< of its last values, as they were counted

    /// Null: gone, or not yet there.
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
    std::size_t bytes = std::size_t{32} << 20;  ///< of all points together, with their order of arrival
    std::size_t services = 200'000;             ///< beyond these a service's values are not kept
    std::size_t of_board = 256;                 ///< the same of one board's services
    std::size_t channels = 16;                  ///< different events of a service
    std::size_t value = 64 * 1024;  ///< the longest text of a value; of a longer one the beginning
    /// Bounds of the last values of one board, and of all: beyond, of a value longer than kShortValue only
    /// so much is kept, and beyond twice of all no value of a new event or service.
    std::size_t board_last_bytes = std::size_t{1} << 20;
    std::size_t last_bytes = std::size_t{64} << 20;
};
inline constexpr std::size_t kShortValue = 256;

/// The last value of each service and a ring of recent ones, counted in bytes with what surrounds them.
/// Values stay until their board is forgotten; the oldest points give way. Pure.
class Values {
  public:
    explicit Values(std::string epoch, ValueLimits limits = {}) : epoch_(std::move(epoch)), limits_(limits) {}
    ~Values();
    Values(const Values&) = delete;
    Values& operator=(const Values&) = delete;

    const std::string& epoch() const { return epoch_; }
    /// `payload`: any bytes. Wakes the feeds that match. Beyond a limit of services or events it is not kept.
    void value(std::string_view board, std::string_view service, std::string_view payload, bool error,
               const Instant& now);
    /// Forgets all services of a board, with everything that is kept of them.
    void forget(std::string_view board);
    /// Earlier reports of a board do not count any more.
    void begin_anew(std::string_view board);
    /// Drops old points. Call now and then.
    void expire(const Instant& now);
    /// Null: nothing was heard. Valid until its board is forgotten.
    const ServiceValues* find(std::string_view board, std::string_view service) const {
        return known(board, service);
    }

    std::size_t services() const { return services_; }
    /// Those of recent values, with their order of arrival.
    std::size_t bytes() const { return bytes_ + arrivals_.size() * sizeof(ServiceValues*); }
    /// Those of the last value of each event of each service.
    std::size_t last_bytes() const { return last_bytes_; }
    std::uint64_t received() const { return received_; }
    std::uint64_t left_out() const { return left_out_; }
    void count_left_out(std::uint64_t values) { left_out_ += values; }

  private:
    friend class ValueFeed;
    struct Board {
        std::vector<std::unique_ptr<ServiceValues>> services;
        std::size_t last_bytes = 0;

        ServiceValues* find(std::string_view service) const {
            for (const auto& each : services)
                if (each->service == service) return each.get();
            return nullptr;
        }
    };
    /// `of`: set to its board.
    ServiceValues* make(std::string_view board, std::string_view service, Board*& of);
    ServiceValues* known(std::string_view board, std::string_view service) const;
    void drop_front(ServiceValues& service);
    void drop_oldest();
    void tidy_arrivals();
    void count_last(Board& board, ServiceValues& service);
    std::size_t room_for(const Board& board, std::size_t bytes) const;
    void add(ValueFeed& feed);
    void remove(ValueFeed& feed);

    std::string epoch_;
    ValueLimits limits_;
    std::map<std::string, Board, std::less<>> boards_;
    std::size_t services_ = 0;
    // The service of each point that is kept, in order; and of some that are gone: dropped_ahead of their
    // service.
    std::deque<ServiceValues*> arrivals_;
    std::size_t gone_arrivals_ = 0;
    std::vector<ValueFeed*> feeds_;
    std::size_t bytes_ = 0;  // without arrivals_
    std::size_t last_bytes_ = 0;
    std::uint64_t received_ = 0;
    std::uint64_t left_out_ = 0;
};

}  // namespace asip::gateway
