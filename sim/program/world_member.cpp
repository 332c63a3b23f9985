// SPDX-License-Identifier: Apache-2.0
#include "sim/program/world_member.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/request_envelope.hpp"
#include "sim/world/outline.hpp"

namespace asip::sim {
namespace {

using member::Announcements;
using nlohmann::ordered_json;
using namespace std::chrono_literals;

constexpr Duration kMoving = 50ms;
constexpr Duration kStanding = 1s;
constexpr Duration kFloor = 5s;
constexpr std::size_t kMaxLinePoints = 400;
constexpr std::size_t kMaxObstacles = 1000;

constexpr std::string_view kFloorModel = R"({
  "name": "floor", "version": 1, "id": "F", "title": "Floor with a line", "element": "point",
  "events": {
    "f": { "name": "floor", "title": "Measures", "per": "event", "fields": [
      { "name": "width", "title": "Width of the line", "type": "number", "unit": "mm" },
      { "name": "off", "title": "Off the track beyond", "type": "number", "unit": "mm" },
      { "name": "radius", "title": "Radius of a rover", "type": "number", "unit": "mm" },
      { "name": "ahead", "title": "Sensors before the axle", "type": "number", "unit": "mm" }] },
    "l": { "name": "line", "title": "Middle of the closed line", "per": "element", "fields": [
      { "name": "x", "type": "number", "unit": "mm" }, { "name": "y", "type": "number", "unit": "mm" }] },
    "o": { "name": "obstacles", "title": "Obstacles", "per": "element", "fields": [
      { "name": "x", "type": "number", "unit": "mm" }, { "name": "y", "type": "number", "unit": "mm" },
      { "name": "r", "title": "Radius", "type": "number", "unit": "mm" }] } } })";

constexpr std::string_view kPoseModel = R"({
  "name": "pose", "version": 1, "id": "P", "title": "Where a rover is",
  "events": {
    "p": { "name": "pose", "per": "event", "fields": [
      { "name": "x", "type": "number", "unit": "mm" }, { "name": "y", "type": "number", "unit": "mm" },
      { "name": "heading", "title": "Counter-clockwise from x", "type": "number", "unit": "degrees" },
      { "name": "offset", "title": "Sensors left of the line", "type": "number", "unit": "mm" },
      { "name": "laps", "type": "integer" },
      { "name": "lap", "title": "Last lap", "type": "number", "unit": "s" }] } } })";

std::shared_ptr<const model::ServiceModel> read(std::string_view text) {
    return std::make_shared<const model::ServiceModel>(model::parse_service_model(text).value());
}

double rounded(double value, double per_unit) {
    return std::round(value * per_unit) / per_unit + 0.0;  // no minus zero
}
double tenths(double value) {
    return rounded(value, 10);
}

std::string floor_of(const world::WorldSpec& spec) {
    return ordered_json{{"floor",
                         {{"width", spec.width_mm},
                          {"off", spec.off_mm},
                          {"radius", spec.rover.radius_mm},
                          {"ahead", spec.rover.sensor_ahead_mm}}}}
        .dump();
}

std::string line_of(const world::World& world) {
    auto points = ordered_json::array();
    for (const auto& point : world::outline(world.track().line(), kMaxLinePoints))
        points.push_back({{"x", tenths(point.x)}, {"y", tenths(point.y)}});
    return ordered_json{{"line", std::move(points)}}.dump();
}

/// The newest ones.
std::string text_of(const std::vector<world::Obstacle>& obstacles) {
    auto list = ordered_json::array();
    for (std::size_t i = obstacles.size() - std::min(obstacles.size(), kMaxObstacles); i < obstacles.size();
         ++i)
        list.push_back({{"x", tenths(obstacles[i].at.x)},
                        {"y", tenths(obstacles[i].at.y)},
                        {"r", tenths(obstacles[i].radius_mm)}});
    return ordered_json{{"obstacles", std::move(list)}}.dump();
}

std::string text_of(const world::World::State& rover) {
    ordered_json pose{{"x", tenths(rover.pose.at.x)},
                      {"y", tenths(rover.pose.at.y)},
                      {"heading", tenths(world::degrees(rover.pose.heading))},
                      {"offset", rounded(rover.offset_mm, 100)},
                      {"laps", rover.laps}};
    if (rover.laps > 0) pose["lap"] = rounded(rover.last_lap.seconds, 1000);
    return ordered_json{{"pose", std::move(pose)}}.dump();
}

}  // namespace

WorldMember::WorldMember(const bus::Topics& topics, WorldIdentity identity,
                         std::shared_ptr<const world::World> world, Random random)
    : topics_(topics),
      identity_(std::move(identity)),
      world_(std::move(world)),
      announcer_(
          topics,
          [this] {
              auto options = identity_.announcer;
              options.board = identity_.name;
              return options;
          }(),
          std::move(random)),
      floor_(floor_of(world_->spec())),
      line_(line_of(*world_)) {
    const auto floor_topic = topics_.service_out(identity_.name, kFloorService);
    floor_said_.topic = line_said_.topic = obstacles_said_.topic = floor_topic;
    for (const auto& rover : identity_.rovers)
        poses_.push_back({topics_.service_out(identity_.name, rover)});
    announcer_.describe(description());
    Announcements none;
    announcer_.set_state(model::BoardState::kOnline, model::StateReason::kNone, {}, none);
}

model::Description WorldMember::description() const {
    model::Description description;
    description.link = {"world", identity_.source, 0};
    description.agent = identity_.agent;
    const auto add = [&](std::string_view name, const std::shared_ptr<const model::ServiceModel>& model) {
        model::ServiceInfo service;
        service.name = name;
        service.id = model->id;
        service.own_model = model;
        description.services.push_back(std::move(service));
    };
    add(kFloorService, read(kFloorModel));
    const auto pose = read(kPoseModel);
    for (const auto& rover : identity_.rovers)
        add(rover, pose);
    return description;
}

std::vector<member::Announcer::Subscription> WorldMember::subscriptions() const {
    auto all = announcer_.subscriptions();
    for (const auto& filter : {topics_.board_in(identity_.name), topics_.service_in(identity_.name, "+"),
                               topics_.stop(identity_.name)})
        all.push_back({filter, {.qos = 1}});
    return all;
}

void WorldMember::on_connected(Time now, Announcements& out) {
    announcer_.on_connected(now, out);
    next_ = floor_said_.due = line_said_.due = obstacles_said_.due = now;
    for (auto& pose : poses_)
        pose.due = now;
}

void WorldMember::on_message(const mqtt::Message& message, Time now, Announcements& out) {
    using bus::TopicKind;
    const auto topic = topics_.parse(message.topic);
    const bool stop = topic && topic->kind == TopicKind::kStop;
    if (!stop && !(topic && (topic->kind == TopicKind::kBoardIn || topic->kind == TopicKind::kServiceIn)))
        return announcer_.on_message(message, now, out);
    if (announcer_.may_publish() && !message.retain) answer(message, stop, out);
}

/// It executes no command. Nothing of a world runs that a stop could end; a refusal would look like a danger.
void WorldMember::answer(const mqtt::Message& command, bool stop, Announcements& out) const {
    const auto envelope = bus::open_envelope(command);
    const auto answer =
        stop && envelope ? bus::Reply::ok("answer", R"({"executed":[],"refused":0})")
                         : bus::Reply::refused(std::string(bus::kRefusedInvalid),
                                               "this is the world of simulated boards; it takes no commands");
    if (auto reply = bus::reply_message(envelope ? envelope->reply : envelope.error().reply, answer))
        out.publish.push_back({std::move(*reply), mqtt::Priority::kReply});
}

void WorldMember::say(Report& report, std::string payload, Duration again, Time now, Announcements& out) {
    if (payload == report.payload && now < report.due) return;
    report.payload = std::move(payload);
    report.due = now + again;
    out.publish.push_back(
        {mqtt::Message{.topic = report.topic, .payload = report.payload}, mqtt::Priority::kContext});
}

void WorldMember::say_obstacles(Time now, Announcements& out) {
    auto obstacles = world_->obstacles();
    if (obstacles == obstacles_ && now < obstacles_said_.due) return;
    say(obstacles_said_, text_of(obstacles), kFloor, now, out);
    obstacles_ = std::move(obstacles);
}

void WorldMember::tick(Time now, bool keeps_up, Announcements& out) {
    announcer_.tick(now, out);
    if (now < next_) return;
    next_ = std::max(next_ + kMoving, now + kMoving / 2);
    if (!announcer_.may_publish() || !keeps_up) return;
    say(floor_said_, floor_, kFloor, now, out);
    say(line_said_, line_, kFloor, now, out);
    say_obstacles(now, out);
    const auto rovers = world_->rovers();
    for (std::size_t i = 0; i < std::min(rovers.size(), poses_.size()); ++i)
        say(poses_[i], text_of(rovers[i]), kStanding, now, out);
}

Time WorldMember::next_deadline() const {
    const auto announcement = announcer_.next_deadline();
    return announcement ? std::min(*announcement, next_) : next_;
}

}  // namespace asip::sim
