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

/// What boards publish, each within its share of the processor. A message is handled as it comes, until its
/// board has used kBurst, or a kPart-th of the time since. From then on its messages have their turns, and
/// until theirs come a newer one on a topic takes the place of the older one. Nothing of other boards waits
/// for them. Pure.
class BoardShares {
  public:
    static constexpr int kPart = 4;
    static constexpr Duration kBurst = std::chrono::milliseconds(100);
    static constexpr std::size_t kMaxBytes = std::size_t{512} << 10;  ///< that wait of a board, with topics
    static constexpr std::size_t kAround = 128;                       ///< bytes of a message, beside its own

    /// `replaced`: called with the topic of each message that gave way to a newer one.
    BoardShares(Shares& shares, std::function<void(const mqtt::Message&)> handle,
                std::function<void(const std::string&)> replaced)
        : shares_(shares), handle_(std::move(handle)), replaced_(std::move(replaced)) {}

    /// Whether what comes on such a topic is counted to its board: boards alone publish there.
    static bool counts(const TopicRef& topic) {
        return !topic.board.empty() && topic.kind != TopicKind::kDemand &&
               topic.kind < TopicKind::kRegistryState;
    }
    void message(std::string_view board, const mqtt::Message& message, Time now);
    /// Forgets boards that used little. Call a few times a second.
    void tick(Time now);
    /// Forgets what waits: it is older than what the next connection brings.
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
