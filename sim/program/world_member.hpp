// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "asip/member/announcer.hpp"
#include "asip/member/bystander.hpp"
#include "sim/world/world.hpp"

namespace asip::sim {

/// The identity of a published world.
struct WorldIdentity {
    std::string name;                      ///< on the bus
    std::string source;                    ///< the world's file, for people: in the description as its link
    std::vector<std::string> rovers;       ///< services' names, in the order of World::rovers()
    member::AnnouncerOptions announcer{};  ///< `board` is filled in
    model::AgentInfo agent{};
};

/// The name of the service that describes the floor; no rover may have it.
inline constexpr std::string_view kFloorService = "floor";
/// A description has room for so many, and the floor.
inline constexpr std::size_t kMaxPublishedRovers = model::kMaxDescriptionServices - 1;

/// A world as a member of the bus: a service `floor` with the line, its measures and the obstacles, and one
/// for each rover with its pose. The floor is published at once, again when it changed, and every 5 s, since
/// nothing of it is retained; a pose 20 times a second while it changes and once a second otherwise. It
/// executes no command. Pure but for the world, which it only reads.
class WorldMember {
  public:
    WorldMember(const bus::Topics& topics, WorldIdentity identity, std::shared_ptr<const world::World> world,
                Random random);

    const std::string& name() const { return identity_.name; }
    /// What the broker publishes when this program dies.
    mqtt::Message will() const { return announcer_.will(); }
    std::vector<member::Announcer::Subscription> subscriptions() const;

    void on_connected(Time now, member::Announcements& out);
    void on_subscribed(Time now, member::Announcements& out) { announcer_.on_subscribed(now, out); }
    void on_disconnected() { announcer_.on_disconnected(); }
    void on_message(const mqtt::Message& message, Time now, member::Announcements& out);

    /// `keeps_up`: the broker takes what is published. While it does not nothing is reported; then what is
    /// newest.
    void tick(Time now, bool keeps_up, member::Announcements& out);
    /// When to call tick() next.
    Time next_deadline() const;

    /// `offline`.
    void goodbye(Time now, member::Announcements& out) { announcer_.goodbye(now, out); }

  private:
    /// One event of a service, and what was said last.
    struct Report {
        std::string topic;
        std::string payload{};
        Time due{};  // said again then, although nothing has changed
    };

    model::Description description() const;
    void say_obstacles(Time now, member::Announcements& out);
    void say(Report& report, std::string payload, Duration again, Time now, member::Announcements& out);
    void answer_stop(const mqtt::Message& stop, member::Announcements& out) const;

    bus::Topics topics_;
    WorldIdentity identity_;
    std::shared_ptr<const world::World> world_;
    member::Bystander bystander_;
    member::Announcer announcer_;
    const std::string floor_, line_;  // do not change
    Report floor_said_, line_said_, obstacles_said_;
    std::vector<world::Obstacle> obstacles_;  // as they were said
    std::vector<Report> poses_;
    Time next_{};
};

}  // namespace asip::sim
