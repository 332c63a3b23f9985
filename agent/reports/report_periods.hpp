// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "agent/bridge/effects.hpp"
#include "agent/reports/demands.hpp"
#include "asip/protocol/request.hpp"
#include "asip/session/board_session.hpp"
#include "asip/session/service_table.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Whether and how the agent sets the periods of reports itself.
struct ReportOptions {
    bool on_demand = false;  ///< false: periods are what commands set, and demands count for nothing
    /// Demands do not bring a service below this; at least 1 ms.
    std::chrono::milliseconds fastest{20};
    std::chrono::milliseconds resting{0};  ///< without a demand; 0: no reports
    /// With on_demand: the agent leaves a service alone until the first demand, and restores its period after
    /// the last.
    bool shared = false;
};

/// The period in ms for `hz` values a second, not below `fastest` nor above `slowest`; 0 where `hz` is 0.
unsigned period_for(double hz, unsigned fastest, unsigned slowest);

/// Sets the report periods of services by demand, and to the resting period a moment after the last demand.
/// Only services whose model has a command `report` with tag `A` and a period in ms take part. A period that
/// a command sets counts as a demand until another is set; 0 ends it. Pure.
class ReportPeriods {
  public:
    /// Between two changes of one service.
    static constexpr Duration kBetweenChanges = std::chrono::seconds(1);
    /// Between two looks at the demands, however many come.
    static constexpr Duration kBetweenLooks = std::chrono::milliseconds(50);
    /// No other client has this number.
    static constexpr session::ClientId kClient = ~session::ClientId{0};

    explicit ReportPeriods(ReportOptions options) : options_(options) {}

    bool on_demand() const { return options_.on_demand; }
    const ReportOptions& options() const { return options_; }

    // --- the bus
    /// A fault: it could not be read.
    void demand(std::string_view demander, const Expected<bus::Demand>& wanted, Time now);

    // --- commands
    /// To be called for each request that is queued.
    void queued(session::RequestId id, const protocol::Request& request);
    /// To be called when any request ends, ours included.
    void on_finished(const session::Finished& end, Time now, Effects& out);

    // --- the board
    /// The board was identified: all periods are set anew.
    void board_found(const session::ServiceTable& services, Time now);

    void tick(session::BoardSession& session, Time now, session::Actions& actions);
    std::optional<Time> next_deadline() const;

    /// The periods of this service are ours to set.
    bool controls(char letter) const;
    /// The period that a shared service has without demand. Nothing: not known, or demands alone set it.
    std::optional<unsigned> own_period(char letter) const;
    /// In ms, by the names of services; unknown periods are left out.
    std::map<std::string, unsigned> periods() const;
    std::size_t demanders() const { return demands_.size(); }
    std::uint64_t rejected() const { return rejected_; }  ///< demands that could not be used
    std::uint64_t changes() const { return changes_; }    ///< periods that were set

  private:
    /// A service whose period is ours to set.
    struct Service {
        char letter = 0;
        std::string name;
        unsigned fastest = 1, slowest = 65535;  // by the model
        std::optional<unsigned> set;            // on the board; none: not known
        bool touched = false;                   // we have set one since the agent began
        std::optional<unsigned> before;         // that it had when we set the first one
        session::RequestId request = 0;         // under way
        unsigned asked = 0;                     // by it
        Time not_before{};
        std::optional<unsigned> failed;  // the last one that could not be set
        Time again{};                    // not before is that one tried again
        Duration patience{};
    };
    /// A client's request that sets a period, until it ends.
    struct Foreign {
        char letter = 0;  // '#': the board restarts
        unsigned period = 0;
    };

    unsigned wanted(const Service& service) const;
    unsigned demanded(const Service& service) const;
    bool left_alone(const Service& service) const;
    Service* find(char letter);
    void foreign_ended(const Foreign& request, const session::Finished& end);
    void own_ended(Service& service, const session::Finished& end, Time now, Effects& out);
    void look_again(Time when);

    ReportOptions options_;
    Demands demands_;
    std::map<char, Service> services_;
    std::map<char, unsigned> commanded_;                       // periods that commands set
    std::unordered_map<session::RequestId, Foreign> foreign_;  // bounded by the session's queue
    std::optional<Time> look_at_;
    std::optional<Time> looked_at_;
    std::uint64_t rejected_ = 0;
    std::uint64_t changes_ = 0;
};

}  // namespace asip::agent
