// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <list>
#include <map>
#include <string>
#include <string_view>

#include "asip/bus/shares.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"

namespace asip::bus {

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
