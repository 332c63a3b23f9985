// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <memory>
#include <optional>
#include <unordered_map>

#include "gateway/stream/budget.hpp"
#include "gateway/stream/feed.hpp"
#include "gateway/stream/values.hpp"

namespace asip::gateway {

/// The values of the services that match: the last ones with their age, `snapshot-end`, then each new one. A
/// reader that is kMaxBehind values of a service behind gets the newest of each event, and `left_out` counts
/// the others. It takes kBytes, kBytesOfService for each service, and the waiting texts.
class ValueFeed : public Feed {
  public:
    static constexpr std::uint64_t kMaxBehind = 64;
    static constexpr std::size_t kBytes = 3 * 1024;
    static constexpr std::size_t kBytesOfDemand = 320;  ///< of each board and service that is demanded
    /// As a listener, in the snapshot, waiting, and with its reading.
    static constexpr std::size_t kBytesOfService = 3 * sizeof(void*) + 80;
    using Allowed = std::function<bool(std::string_view board, std::string_view service)>;

    struct Options {
        std::string board = "*";  ///< patterns
        std::string service = "*";
        double max_hz = 0;  ///< newest value of a service at most so often; 0: each
        /// For one service only: resume behind this. Where it is gone, `reset` and the state follow.
        std::optional<Place> after;
        /// For patterns: resume each service behind its place. A service without one begins with its last
        /// values; where values are gone the newest is sent, with `left_out`.
        std::optional<Places> after_each;
        Allowed allowed;                 ///< empty: everything
        std::shared_ptr<void> demand{};  ///< what makes the boards report, kept as long as the feed
        std::size_t demands = 1;         ///< how many boards and services, or patterns of them, that is
        Budget::Part part{};             ///< of the reader
    };

    ValueFeed(Values& values, Options options);
    ~ValueFeed() override;

    bool next(StreamEvent& event, const Instant& now) override;
    void tick(const Instant& now) override;
    std::string_view fault() const override { return fault_; }
    std::uint64_t left_out() const { return left_out_; }

  private:
    friend class Values;
    struct Reading {
        std::uint64_t sent = 0;  // number of the last point that the reader has, or that one replaced
        bool queued = false;
        bool resumed = false;  // it gets each value of before, however many
        Time not_before{};
    };
    enum class Phase { kReset, kSnapshot, kSnapshotEnd, kLive };

    bool exact() const;
    void resume_one();
    void resume_each();
    std::optional<std::uint64_t> place_of(const ServiceValues& service) const;
    void appeared(ServiceValues& service);
    void arrived(ServiceValues& service, Time now);
    void vanished(ServiceValues& service);
    void queue(ServiceValues& service, Reading& reading);
    void read_next(const Instant& now);
    bool next_snapshot(StreamEvent& event, const Instant& now);
    void read_service(ServiceValues& service, Reading& reading, const Instant& now);
    void newest_of_each(ServiceValues& service, Reading& reading);
    StreamEvent taken();
    void too_much();
    void put(std::uint64_t number, const ChannelValue& channel, std::string data, bool placed);

    Values* values_;
    std::string board_;
    std::string service_;
    Duration interval_{};
    std::optional<Place> after_;
    std::optional<Places> after_each_;
    Allowed allowed_;
    std::shared_ptr<void> demand_;
    Budget::Part part_;
    std::string_view fault_;
    Phase phase_ = Phase::kSnapshot;
    std::string_view reset_reason_;
    std::deque<ServiceValues*> snapshot_;
    std::deque<ServiceValues*> ready_;
    std::unordered_map<ServiceValues*, Reading> readings_;  // without those of which the reader has all
    std::uint64_t snapshot_number_ = 0;                     // of one service: the last in its snapshot
    std::deque<StreamEvent> out_;
    std::uint64_t left_out_ = 0;
};

}  // namespace asip::gateway
