// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "asip/time.hpp"

namespace asip::bus {

/// Shares the processor among clients and boards. What is to be done for one of them is a job of its name;
/// of the names that have jobs the one goes next that has used the least time. What a name used while no
/// other wanted it is forgotten, and one that was away saves nothing up. Urgent jobs go ahead of all others,
/// in the same order among themselves. One thread; it reads no clock of its own.
class Shares {
  public:
    static constexpr Duration kSlice = std::chrono::milliseconds(2);  ///< of run()
    /// One step. True: there is more to do, in another turn.
    using Job = std::function<bool()>;

    /// `clock`: of what jobs use: processor_time(). `wake`: called when there is a job and
    /// there was none; run() must be called then, and again as long as it returns true, with what else the
    /// program has to do in between.
    Shares(std::function<Duration()> clock, std::function<void()> wake)
        : clock_(std::move(clock)), wake_(std::move(wake)) {}

    void add(const std::string& name, Job job, bool urgent = false);
    /// At least one step, then others for kSlice. True: there are more.
    bool run();
    /// Names of which anything is known: those that have jobs, or have used more than others.
    std::size_t names() const { return accounts_.size(); }
    Duration now() const { return clock_(); }
    /// The time of this thread alone: what other programs use meanwhile is counted to nobody.
    static Duration processor_time();

  private:
    struct Account {
        Duration used{};
        std::deque<Job> urgent, others;
    };
    using Accounts = std::map<std::string, Account, std::less<>>;
    using Place = std::tuple<bool, Duration, const std::string*>;  // not urgent, used, name
    static Place place_of(const Accounts::value_type& account);
    void step();

    std::function<Duration()> clock_;
    std::function<void()> wake_;
    Accounts accounts_;
    std::set<Place> waiting_;
    Duration least_{};  // that one which had its turn had used before it
    const Accounts::value_type* running_ = nullptr;
};

}  // namespace asip::bus
