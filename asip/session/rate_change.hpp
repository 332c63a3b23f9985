// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <set>
#include <string>
#include <vector>

#include "asip/protocol/message.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// The rates that a board may be moved to.
class Rates {
  public:
    /// The fastest allowed rate that has not failed.
    unsigned best(unsigned max_baud) const;
    void mark_bad(unsigned baud) { bad_.insert(baud); }
    void forget_bad() { bad_.clear(); }

  private:
    std::set<unsigned> bad_;
};

/// Moves a board to a faster rate and tries that with a burst of fences. When a rate fails, the session
/// searches the board anew, which returns to its start rate or stays.
class RateChange {
  public:
    enum class Step {
        kAsked,      ///< `#,B,baud` is out
        kSwitching,  ///< the shell sets the rate
        kFirst,      ///< fences at the new rate until one comes back
        kBurst,      ///< many fences, all of which must
        kDone,
        kRefused,  ///< the board is still at the old rate, and nothing was switched
        kFailed,
    };

    /// `token_start`: two letters or digits that begin every token of this change.
    RateChange(unsigned baud, std::string token_start, Time now, std::vector<std::string>& lines);

    Step step() const { return step_; }
    unsigned baud() const { return baud_; }

    /// True: the line was for us. In kSwitching the shell has to set the rate.
    bool on_event(const protocol::Event& event, Time now, std::vector<std::string>& lines);
    bool on_error(const protocol::ErrorReply& error);
    void on_garbage();
    void on_rate_set(bool ok, Time now, std::vector<std::string>& lines);
    void on_deadline(Time now, std::vector<std::string>& lines);
    Time next_deadline() const { return deadline_; }

  private:
    std::string first_token() const { return token_start_ + "first"; }
    std::string burst_token(unsigned number) const {
        return token_start_ + "bur" + std::to_string(100 + number);
    }
    void fence(std::vector<std::string>& lines);

    Step step_ = Step::kAsked;
    unsigned baud_;
    std::string token_start_;
    int tries_ = 0;
    unsigned sent_ = 0;
    unsigned received_ = 0;
    Time deadline_;
};

/// Rates a board may be found at and moved to, fastest first.
inline constexpr unsigned kFastRates[] = {1'000'000, 500'000, 250'000, 115'200};

}  // namespace asip::session
