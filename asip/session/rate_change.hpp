#pragma once
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "asip/protocol/message.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// The fold that moves a board with the line-rate extension to the fastest rate that survives a burst test.
/// It never goes back by itself: when a rate fails, the session searches the board anew (it returns to its
/// start rate, or stays and is found there) and asks again; the failed rate is not tried any more.
class RateChange {
  public:
    enum class Step {
        kIdle,
        kAsked,      ///< `#,B,baud` is out
        kSwitching,  ///< the shell sets the rate
        kFirst,      ///< fences at the new rate until one comes back
        kBurst,      ///< many fences, all of which must
        kDone,
        kFailed,
    };

    /// The fastest rate allowed that has not failed.
    unsigned best(unsigned max_baud) const;
    void mark_bad(unsigned baud) { bad_.insert(baud); }
    bool is_bad(unsigned baud) const { return bad_.contains(baud); }
    void forget_bad() { bad_.clear(); }

    void start(unsigned baud, Time now, std::vector<std::string>& lines);
    void cancel() { step_ = Step::kIdle; }

    Step step() const { return step_; }
    unsigned baud() const { return baud_; }
    bool busy() const { return step_ != Step::kIdle && step_ != Step::kDone && step_ != Step::kFailed; }

    /// True: the line was meant for us. In kSwitching the shell has to set the rate.
    bool on_event(const protocol::Event& event, Time now, std::vector<std::string>& lines);
    bool on_error(const protocol::ErrorReply& error);
    void on_garbage();
    void on_rate_set(bool ok, Time now, std::vector<std::string>& lines);
    void on_deadline(Time now, std::vector<std::string>& lines);
    Time next_deadline() const { return deadline_; }

    /// Whether the board refused: it is still at the old rate, and nothing was switched.
    bool refused() const { return refused_; }

  private:
    void fence(std::vector<std::string>& lines);
    void fail();

    Step step_ = Step::kIdle;
    unsigned baud_ = 0;
    bool refused_ = false;
    int tries_ = 0;
    unsigned sent_ = 0;
    unsigned received_ = 0;
    Time deadline_{};
    std::set<unsigned> bad_;
};

/// Rates a board may be found at and moved to, fastest first.
inline constexpr unsigned kFastRates[] = {1'000'000, 500'000, 250'000, 115'200};

}  // namespace asip::session
