// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "tests/truth/presence/sim_agent.hpp"
#include "tests/truth/presence/views.hpp"

namespace truth::presence {

inline constexpr Time kBegin = Time{} + std::chrono::seconds(1000);
/// What happens is in every view within this time.
inline constexpr Duration kPromised = std::chrono::seconds(1);

/// Since the history began.
double seconds(Time time);

/// What a whole history has in common.
struct Setting {
    bool in_order = true;    ///< one broker; else bridged ones
    bool says_state = true;  ///< agents; those of older versions say it on `$state` alone
    int lease = 10;          ///< seconds
};

/// Compares what a view says of a board with what is so.
class Judge {
  public:
    Judge(const Setting& setting, const SimBroker& broker) : setting_(setting), broker_(broker) {}

    /// What is wrong with what the view says now; empty: nothing. `compared` is counted up.
    std::string says(View& view, const std::string& board, const BoardTruth& truth, Time now,
                     std::uint64_t& compared) const;
    /// The same of the changes that it told. Each change is told once: what a registry tells is what was
    /// said, in that order, and the ends of leases. What came to be while a reset was due is part of it.
    std::string told(const View& view, const std::string& board, const BoardTruth& truth) const;

    /// What came in another order is put right by the next renewal.
    Duration settling() const;
    Time last_description(const std::string& board) const;

  private:
    /// What the view may say: where it had no chance to know which session is the later one, each.
    std::vector<Really> possible(const View& view, const BoardTruth& truth, Time now) const;
    std::string differs(const View& view, const std::optional<asip::bus::BoardItem>& seen,
                        const Really& really, const BoardTruth& truth, Time now) const;
    std::string reason_and_time(const View& view, const asip::bus::BoardItem& seen, const Really& really,
                                const BoardTruth& truth, Time now) const;

    const Setting& setting_;
    const SimBroker& broker_;
};

}  // namespace truth::presence
