// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "asip/mqtt/backoff.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// What is asked of the broker for one filter.
struct SubscribeOptions {
    int qos = 0;            ///< 0 or 1
    bool no_local = false;  ///< MQTT 5: not what this client itself publishes
    /// MQTT 5: whether retained messages are delivered when we subscribe. On 3.1.1 they always are, marked as
    /// retained.
    bool retained = true;
    /// The connection is of no use without it: it is asked for before those that are not, and a broker that
    /// refuses it kMaxRefusals times in a row is left for the next one of the list.
    bool required = false;
};

/// Which subscriptions are wanted and how far the broker has granted them. A refused one is due again after a
/// growing pause (1 s to 30 s), and then with QoS 0, because NATS refuses only QoS 1 while a node is dead.
/// Pure: the caller sends what is due and reports what the broker answered. What a call costs does not grow
/// with the number of subscriptions that are granted.
class Subscriptions {
  public:
    static constexpr int kMaxRefusals = 3;
    static constexpr Duration kBusy = std::chrono::milliseconds(500);
    /// Below Options::ack_timeout, which does not run while the broker has a subscription to answer.
    static constexpr Duration kMostDeference = std::chrono::seconds(5);

    using Sending = std::pair<std::string, SubscribeOptions>;
    struct Refusal {
        std::string filter;
        bool first = false;    ///< the first of this connection
        bool give_up = false;  ///< required, and refused kMaxRefusals times in a row
        Duration after{};      ///< from sending to this answer
    };

    /// The same filter again replaces its options and is due again.
    void add(const std::string& filter, SubscribeOptions options);
    void remove(const std::string& filter);

    /// A new connection: nothing is granted, everything is due. `defers`: to a busy broker, see due().
    void restart(bool defers = false);

    /// What is to be sent now; each is to be followed by sent() unless it could not be sent. While one that
    /// is required has no answer yet, none that is not: of all who come from a broker that is gone, at the
    /// same moment, the next one serves first what they cannot work without. After restart(true), and where
    /// the last of these took kBusy or longer, what is not required waits as long again, for kMostDeference
    /// at the most: others are likely to wait for theirs.
    std::vector<Sending> due(Time now) const;
    bool holds_back(Time now) const { return required_.unanswered > 0 || now < others_from_; }
    /// `id`: the packet id that the broker will answer.
    void sent(int id, const std::string& filter, Time now);

    /// The broker's answer to the packet `id`.
    std::optional<Refusal> answered(int id, bool granted, Time now, const Random& random);

    /// Whether the broker has granted those that are required; all, where none is; true when there are none.
    bool usable() const { return (required_.wanted > 0 ? required_ : others_).all_granted(); }
    /// Whether the broker has granted each.
    bool all_granted() const { return required_.all_granted() && others_.all_granted(); }
    /// Whether one has no answer yet; one that was refused has.
    bool unanswered() const { return required_.unanswered + others_.unanswered > 0; }
    /// When the oldest packet without an answer was sent.
    std::optional<Time> waiting_since() const;

  private:
    enum class State { kDue, kSent, kGranted, kRefused };
    struct Wanted {
        SubscribeOptions options;
        State state = State::kDue;
        int refusals = 0;
        Time again{};
        Backoff backoff{std::chrono::seconds(1), std::chrono::seconds(30)};
    };
    struct Sent {
        std::string filter;
        Time at;
    };

    /// Those that are required, or those that are not: of the latter there may be many that are held back.
    struct Group {
        std::set<std::string> open;  // due or refused
        std::size_t wanted = 0;
        std::size_t granted = 0;
        std::size_t unanswered = 0;  // due or sent
        bool all_granted() const { return granted == wanted; }
    };

    Group& group_of(const Wanted& wanted) { return wanted.options.required ? required_ : others_; }
    void count(const Wanted& wanted, std::ptrdiff_t by);
    void set(Wanted& wanted, const std::string& filter, State state);
    void add_due(const Group& group, Time now, std::vector<Sending>& result) const;

    std::map<std::string, Wanted> wanted_;
    Group required_;
    Group others_;
    bool defers_ = false;
    Time others_from_{};
    std::unordered_map<int, Sent> unanswered_;
};

}  // namespace asip::mqtt
