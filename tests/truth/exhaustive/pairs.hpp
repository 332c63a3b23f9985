// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "tests/truth/exhaustive/undisturbed.hpp"

namespace truth {

/// Every pair of two faults of a scenario. What comes before the second fault is played once for all second
/// faults. After the first fault a history may come to a state that another had after its first fault, with
/// as much sent at the same time: its second faults were all tried there.
class Pairs {
  public:
    struct Count {
        std::uint64_t pairs = 0;
        std::uint64_t played = 0;  ///< each from its second fault on
        std::uint64_t equal = 0;   ///< of these ended in a state from which another had gone on to a good end
        Counts counts;
    };
    /// Called with each that was played, by the numbers of its faults. False: enough.
    using Played = std::function<bool(std::size_t, std::size_t, TrialEnd& end)>;

    Pairs(Undisturbed& undisturbed, const std::vector<Faults>& faults, Played played);

    Count run();

  private:
    /// Where a history may go on from.
    struct From {
        const Trial* trial;  // null: the beginning
        const Firmware::Saved* firmware;
    };
    bool all_behind(std::size_t first);
    bool each_since(const Range& sent, Micros time, const From& from, std::size_t first, bool same_step);
    bool play(const From& from, std::size_t first, std::size_t second);

    Undisturbed& undisturbed_;
    const std::vector<Faults>& faults_;
    Played played_;
    std::vector<std::size_t> steps_;  // in which they come, by number of the fault
    std::map<std::uint64_t, std::vector<std::size_t>> to_board_, to_host_;  // by number of the byte
    std::multimap<Micros, std::size_t> incidents_;                          // by time
    std::unique_ptr<Trial> lead_, before_, trial_;
    KnownStates after_first_;
    Count count_;
};

/// Both.
Faults both(const Faults& first, const Faults& second);

}  // namespace truth
