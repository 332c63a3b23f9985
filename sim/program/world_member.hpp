// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "asip/member/announcer.hpp"
#include "sim/world/world.hpp"

namespace asip::sim {

struct WorldIdentity {
    std::string name;                      ///< on the bus
    std::string source;                    ///< the world's file, for people: in the description as its link
    std::vector<std::string> rovers;       ///< services' names, in the order of World::rovers()
    member::AnnouncerOptions announcer{};  ///< `board` is filled in
    model::AgentInfo agent{};
};

/// No rover may have this name.
inline constexpr std::string_view kFloorService = "floor";
/// What a description has room for, beside the floor.
inline constexpr std::size_t kMaxPublishedRovers = model::kMaxDescriptionServices - 1;

/// A world on the bus: a service `floor` with line, measures and obstacles, and one for each rover with its
/// pose. The floor is published at once, on changes, and every 5 s; a pose 20 times a second while it
/// changes, else once. It executes no command. Pure but for the world, which it reads.
class WorldMember {
  public:
    WorldMember(const bus::Topics& topics, WorldIdentity identity, std::shared_ptr<const world::World> world,
                Random random);

    const std::string& name() const { return identity_.name; }
    mqtt::Message will() const { return announcer_.will(); }
    std::vector<member::Announcer::Subscription> subscriptions() const;

    void on_connected(Time now, member::Announcements& out);
    void on_subscribed(Time now, member::Announcements& out) { announcer_.on_subscribed(now, out); }
    void on_disconnected() { announcer_.on_disconnected(); }
    void on_message(const mqtt::Message& message, Time now, member::Announcements& out);

    /// `keeps_up`: the broker takes what is published; else only the newest follows.
    void tick(Time now, bool keeps_up, member::Announcements& out);
    Time next_deadline() const;

    /// `offline`.
    void goodbye(Time now, member::Announcements& out) { announcer_.goodbye(now, out); }

  private:
    /// And what was said last.
    struct Report {
        std::string topic;
        std::string payload{};
        Time due{};  // said again then, although nothing has changed
    };

    model::Description description() const;
    void say_obstacles(Time now, member::Announcements& out);
    void say(Report& report, std::string payload, Duration again, Time now, member::Announcements& out);
    void answer(const mqtt::Message& command, bool stop, member::Announcements& out) const;

    bus::Topics topics_;
    WorldIdentity identity_;
    std::shared_ptr<const world::World> world_;
    member::Announcer announcer_;
    const std::string floor_, line_;  // do not change
    Report floor_said_, line_said_, obstacles_said_;
    std::vector<world::Obstacle> obstacles_;  // as they were said
    std::vector<Report> poses_;
    Time next_{};
};

}  // namespace asip::sim
