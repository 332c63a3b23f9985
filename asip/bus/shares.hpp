// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"

namespace asip::bus {

/// Shares the processor among names with jobs: the one that used the least time goes next. What a name used
/// while no other wanted it is forgotten, and absence saves nothing up. Urgent jobs go first, in the same
/// order among themselves, but for those of a name whose urgent ones used kUrgent meanwhile. One thread; no
/// clock of its own.
class Shares {
  public:
    static constexpr Duration kSlice = std::chrono::milliseconds(2);  ///< of run()
    static constexpr Duration kUrgent = std::chrono::milliseconds(50);
    /// One step. True: there is more to do.
    using Job = std::function<bool()>;

    /// `clock`: processor_time(). `wake`: the first job came: call run(), and again as long as it returns
    /// true, between other work.
    Shares(std::function<Duration()> clock, std::function<void()> wake)
        : clock_(std::move(clock)), wake_(std::move(wake)) {}

    void add(const std::string& name, Job job, bool urgent = false);
    /// At least one step, then others for kSlice. True: there are more.
    bool run();
    /// With jobs, or above others in use.
    std::size_t names() const { return accounts_.size(); }
    Duration now() const { return clock_(); }
    static constexpr Duration kBetweenLooks = std::chrono::microseconds(200);
    /// This thread's alone; up to kBetweenLooks too much, where the thread slept meanwhile.
    static Duration processor_time();

  private:
    struct Account {
        Duration used{};
        Duration used_urgently{};
        std::deque<Job> urgent, others;
    };
    using Accounts = std::map<std::string, Account, std::less<>>;
    using Place = std::tuple<bool, Duration, const std::string*>;  // goes behind, used, name
    static Place place_of(const Accounts::value_type& account);
    Duration step(Duration began);  ///< returns when it ended

    std::function<Duration()> clock_;
    std::function<void()> wake_;
    Accounts accounts_;
    std::set<Place> waiting_;
    Duration least_{};  // that one which had its turn had used before it
    const Accounts::value_type* running_ = nullptr;
};

/// What boards publish, each within its share. A message is handled as it comes, until its board has used
/// kBurst, or a kPart-th of the time since. Then its messages wait for their turns, and a newer one on a
/// topic replaces an older one. Nothing of other boards waits. Pure.
class BoardShares {
  public:
    static constexpr int kPart = 4;
    static constexpr Duration kBurst = std::chrono::milliseconds(100);
    static constexpr std::size_t kMaxBytes = std::size_t{512} << 10;  ///< that wait of a board, with topics
    static constexpr std::size_t kAround = 128;                       ///< bytes of a message, beside its own

    /// `replaced`: the topic of each message that gave way.
    BoardShares(Shares& shares, std::function<void(const mqtt::Message&)> handle,
                std::function<void(const std::string&)> replaced)
        : shares_(shares), handle_(std::move(handle)), replaced_(std::move(replaced)) {}

    /// Boards alone publish on such topics.
    static bool counts(const TopicRef& topic) {
        return !topic.board.empty() && topic.kind != TopicKind::kDemand &&
               topic.kind < TopicKind::kRegistryState;
    }
    void message(std::string_view board, const mqtt::Message& message, Time now);
    /// Forgets boards that used little. A few times a second.
    void tick(Time now);
    /// What waits is older than what the next connection brings.
    void disconnected();
    std::size_t boards() const { return boards_.size(); }

  private:
    struct Board {
        Duration left = kBurst;
        Time at{};
        std::list<mqtt::Message> waiting;
        std::size_t bytes = 0;
    };
    using Boards = std::map<std::string, Board, std::less<>>;
    void wait(Boards::value_type& board, const mqtt::Message& message);
    void drop(Board& board, std::list<mqtt::Message>::iterator which);
    bool next(const std::string& name);
    static void refill(Board& board, Time now);

    Shares& shares_;
    std::function<void(const mqtt::Message&)> handle_;
    std::function<void(const std::string&)> replaced_;
    Boards boards_;
};

}  // namespace asip::bus
