// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "agent/reports/report_periods.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/session/board_session.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Durations, counted in fixed buckets.
class Histogram {
  public:
    /// Upper bounds in seconds; one more bucket takes the rest.
    static constexpr std::array<double, 19> kBounds{.0005, .001, .002, .003, .005, .007, .01, .015, .02, .03,
                                                    .05,   .07,  .1,   .2,   .5,   1,    2,   5,    60};
    using Counts = std::array<std::uint64_t, kBounds.size() + 1>;

    void add(Duration took);
    void clear() { *this = Histogram{}; }

    const Counts& counts() const { return counts_; }
    std::uint64_t count() const { return count_; }
    /// In seconds.
    double sum() const { return sum_; }
    /// The seconds that `part` (0 to 1) of them stay below, interpolated within a bucket; none: nothing was
    /// counted.
    std::optional<double> quantile(double part) const;

  private:
    Counts counts_{};
    std::uint64_t count_ = 0;
    double sum_ = 0;
};

/// What an agent counts, and the document that it publishes of it (docs/service-bus.md, "Statistics").
/// Bounded, whatever boards and clients do. Counters never go back: readers see a restart by the session.
/// Pure.
class Statistics {
  public:
    /// Numbers that other rooms count.
    struct Sources {
        const session::BoardSession& session;
        mqtt::Counters bus;
        std::string board;
        std::string agent_session;
        std::uint64_t forgotten_answers = 0;
        std::size_t holds = 0;  ///< in force now
        const ReportPeriods& periods;
        std::uint64_t undecoded = 0;  ///< reports that do not fit their model
    };

    // --- the board and its link
    void link_opened(Time now);
    void received(std::string_view bytes) { bytes_in_ += bytes.size(); }
    void sent(std::string_view bytes);
    /// `code`: of the protocol, or any other.
    void board_error(int code);

    // --- commands and values
    void value_superseded() { ++superseded_; }
    void hold_expired() { ++expired_holds_; }
    void stopped() { ++stops_; }
    /// `proven`: the sender wanted an answer. `took`: from the command's arrival on.
    void answered(const bus::Reply& reply, bool proven, Duration took);

    /// JSON. Quantiles cover the time since the last document.
    std::string document(const Sources& sources, Time now);

  private:
    std::uint64_t links_ = 0;
    std::uint64_t bytes_in_ = 0;
    std::uint64_t bytes_out_ = 0;
    std::uint64_t lines_out_ = 0;
    std::uint64_t superseded_ = 0;
    std::uint64_t expired_holds_ = 0;
    std::uint64_t stops_ = 0;
    std::uint64_t documents_ = 0;
    std::map<int, std::uint64_t> errors_;            // by code; those beyond kMaxCodes under -1
    std::map<std::string, std::uint64_t> outcomes_;  // "ok", "refused/queue-full"
    Histogram round_trips_;
    Histogram recent_round_trips_;  // since the last document
    std::optional<Time> started_;
    std::optional<Time> last_;
};

}  // namespace asip::agent
