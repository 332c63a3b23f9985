// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/bus/request/reply.hpp"
#include "asip/bus/topics.hpp"
#include "asip/member/announcer.hpp"
#include "bench/load/board_kind.hpp"

namespace asip::load {

/// How a simulated board answers commands: nothing executes them.
inline constexpr std::string_view kProofSimulated = "simulated";

/// A board as a member of the bus: announced as its agent would, by the same code, and answering commands.
/// Pure: it returns what to publish. `topics` and `kind` must outlive it.
class SimulatedBoard {
  public:
    SimulatedBoard(const bus::Topics& topics, const BoardKind& kind, member::AnnouncerOptions options,
                   model::Description description, Random random);

    /// What the broker publishes when the board dies; valid from the start.
    mqtt::Message will() const { return announcer_.will(); }
    /// What a board of this name subscribes to.
    static std::vector<member::Announcer::Subscription> subscriptions(const bus::Topics& topics,
                                                                      const std::string& name);

    /// `expires`: what this broker retains.
    void on_connected(Time now, member::Announcements& out, bool expires = true) {
        announcer_.on_connected(now, out, expires);
    }
    void on_subscribed(Time now, member::Announcements& out) { announcer_.on_subscribed(now, out); }
    void on_disconnected() { announcer_.on_disconnected(); }
    /// Returns whether it was a command, and was answered or was not to be.
    bool on_message(const mqtt::Message& message, Time now, member::Announcements& out);
    void tick(Time now, member::Announcements& out) { announcer_.tick(now, out); }
    std::optional<Time> next_deadline() const { return announcer_.next_deadline(); }
    void goodbye(Time now, member::Announcements& out) { announcer_.goodbye(now, out); }

    /// Whether the name is its own, and the bus is there.
    bool announced() const { return announcer_.may_publish(); }
    /// One value of each service; nothing where it may not publish.
    void report(member::Announcements& out) const;

  private:
    void answer(const mqtt::Message& command, const bus::TopicRef& topic, member::Announcements& out);
    /// Labels, names and meanings, as an agent keeps them, but until the board ends only.
    bus::Reply label(const nlohmann::json& wanted);

    const bus::Topics& topics_;
    const BoardKind& kind_;
    std::string name_;
    model::Description description_;
    member::Announcer announcer_;
};

}  // namespace asip::load
