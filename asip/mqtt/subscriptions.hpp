// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "asip/mqtt/backoff.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::mqtt {

/// For one filter.
struct SubscribeOptions {
    int qos = 0;            ///< 0 or 1
    bool no_local = false;  ///< MQTT 5: not what this client itself publishes
    /// Retained messages are delivered when we subscribe (MQTT 5; on 3.1.1 always, marked as retained).
    bool retained = true;
    /// The connection is useless without it: it goes first, and a broker that refuses it kMaxRefusals times
    /// in a row is left.
    bool required = false;
};

/// Which subscriptions are wanted and granted. A refused one is due again after 1 s to 30 s. The cost of a
/// call does not grow with granted ones. Pure.
class Subscriptions {
  public:
    static constexpr int kMaxRefusals = 3;

    struct Due {
        std::string filter;
        SubscribeOptions options;
        bool was_refused = false;  ///< on this connection
    };
    struct Refusal {
        std::string filter;
        bool first = false;    ///< the first of this connection
        bool give_up = false;  ///< required, and refused kMaxRefusals times in a row
    };

    /// Replaces the filter's options; it is due again.
    void add(const std::string& filter, SubscribeOptions options);
    void remove(const std::string& filter);

    /// Nothing is granted, everything is due.
    void restart();

    /// Required ones first. Nothing is due again before it is answered, or not_sent().
    std::vector<Due> take_due(Time now);
    /// `id`: of the packet.
    void sent(int id, const std::string& filter, Time now);
    void not_sent(const std::string& filter);

    /// The broker's answer to packet `id`.
    std::optional<Refusal> answered(int id, bool granted, Time now, const Random& random);

    /// All required ones are granted, or all where none is required; also when there are none.
    bool usable() const { return (required_.wanted > 0 ? required_ : optional_).all_granted(); }
    /// When the oldest unanswered packet was sent.
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
    struct Group {
        std::set<std::string> open;  // due or refused
        std::size_t wanted = 0;
        std::size_t granted = 0;
        bool all_granted() const { return granted == wanted; }
    };

    Group& group_of(const Wanted& wanted) { return wanted.options.required ? required_ : optional_; }
    void set(Wanted& wanted, const std::string& filter, State state);
    void take_due(Group& group, Time now, std::vector<Due>& result);

    std::map<std::string, Wanted> wanted_;
    Group required_;
    Group optional_;
    std::unordered_map<int, Sent> unanswered_;
};

}  // namespace asip::mqtt
