// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <list>

#include "cli/ask/bus_session.hpp"

namespace asip::cli {

inline constexpr std::size_t kAskedAtOnce = 128;

/// Asks many, at most `at_once` at a time: `begin(one)` asks and returns its deadline; `ended(one)`: nothing
/// more can come. Returns when all have ended or had their time, or the user asks to end. `all` must not
/// change.
template <class One, class Begin, class Ended>
void ask_side_by_side(BusSession& session, std::list<One*> all, std::size_t at_once, Begin begin,
                      Ended ended) {
    struct Open {
        One* one;
        Time deadline;
    };
    std::list<Open> open;
    while (!session.stopped() && (!all.empty() || !open.empty())) {
        while (open.size() < at_once && !all.empty()) {
            open.push_back({all.front(), begin(*all.front())});
            all.pop_front();
        }
        const auto over = [&ended](const Open& each) {
            return ended(*each.one) || Clock::now() >= each.deadline;
        };
        const auto first = std::min_element(
            open.begin(), open.end(), [](const Open& a, const Open& b) { return a.deadline < b.deadline; });
        session.run_until([&] { return std::any_of(open.begin(), open.end(), over); }, first->deadline);
        open.remove_if(over);
    }
}

}  // namespace asip::cli
