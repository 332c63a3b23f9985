// SPDX-License-Identifier: Apache-2.0
// A world on the bus, without a bus: time and world in, messages out.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "sim/program/world_member.hpp"
#include "sim/world/outline.hpp"

namespace asip::sim {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;
using testing::SizeIs;

constexpr double kFullPower = 1;

/// A square metre with one rover, on the bus as `world`, and the messages that it published.
class WorldMemberTest : public testing::Test {
  protected:
    static std::shared_ptr<world::World> square() {
        world::WorldSpec spec;
        spec.line = {{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}};
        spec.rover.lag_ms = 0;
        return world::World::create(spec).value();
    }

    void SetUp() override { rover_ = world_->add_on_line(300); }

    WorldMember& member() {
        if (!member_)
            member_.emplace(bus::Topics(), WorldIdentity{"world", "square.json", {"mirto"}, {}, {}}, world_,
                            random_);
        return *member_;
    }

    void connect() {
        take([this](auto& out) { member().on_connected(now_, out); });
        take([this](auto& out) { member().on_subscribed(now_, out); });
    }

    /// Lets time pass, the rover driving at `power`.
    void pass(Duration time, double power = 0, bool keeps_up = true) {
        for (const auto end = now_ + time; now_ < end; now_ += 1ms) {
            world_->step(rover_, power, power, 0.001);
            if (now_ < member().next_deadline()) continue;
            take([&](auto& out) { member().tick(now_, keeps_up, out); });
        }
    }

    void announce() {
        connect();
        pass(1500ms);
        said_.clear();
    }

    template <class Call>
    void take(Call&& call) {
        member::Announcements out;
        call(out);
        EXPECT_FALSE(out.fatal);
        for (auto& publication : out.publish)
            said_.push_back(std::move(publication.message));
    }

    std::vector<json> events(const std::string& topic, const std::string& event) const {
        std::vector<json> found;
        for (const auto& message : said_)
            if (message.topic == topic && json::parse(message.payload).contains(event))
                found.push_back(json::parse(message.payload)[event]);
        return found;
    }
    std::vector<json> poses() const { return events("asip/world/mirto/out", "pose"); }
    std::vector<json> floors(const std::string& event) const { return events("asip/world/floor/out", event); }

    std::string last(const std::string& topic) const {
        std::string payload;
        for (const auto& message : said_)
            if (message.topic == topic) payload = message.payload;
        return payload;
    }

    mqtt::Message command(const std::string& topic) const {
        return mqtt::Message{.topic = topic, .payload = R"({"report":100,"reply_to":"me","id":"7"})"};
    }

    std::shared_ptr<world::World> world_ = square();
    world::World::RoverId rover_ = 0;
    Time now_ = Time(1h);
    Random random_ = [] { return std::uint64_t{0x1234567890abcdef}; };
    std::optional<WorldMember> member_;
    std::vector<mqtt::Message> said_;
};

TEST_F(WorldMemberTest, Name_IsClaimedBeforeAnythingIsSaid) {
    connect();
    pass(1200ms, kFullPower);
    EXPECT_EQ(last("asip/servicebus/$probe"), "world");
    EXPECT_THAT(said_, SizeIs(1));
    pass(300ms, kFullPower);
    EXPECT_EQ(last("asip/servicebus/world/$state"), "online");
    EXPECT_THAT(poses(), testing::Not(testing::IsEmpty()));
}

TEST_F(WorldMemberTest, Description_NamesFloorAndRoversWithTheirModels) {
    connect();
    pass(1500ms);
    const auto description = model::parse_description(last("asip/servicebus/world/$description"));
    ASSERT_TRUE(description) << description.error();
    ASSERT_THAT(description->services, SizeIs(2));
    EXPECT_EQ(description->link.path, "square.json");
    ASSERT_TRUE(description->service("floor")->own_model);
    EXPECT_NE(description->service("floor")->own_model->event_named("line"), nullptr);
    EXPECT_NE(description->service("mirto")->own_model->event_named("pose"), nullptr);
}

TEST_F(WorldMemberTest, Description_HasRoomForAsManyRoversAsAreAllowed) {
    WorldIdentity identity{"world", "square.json", {}, {}, {}};
    for (std::size_t i = 0; i < kMaxPublishedRovers; ++i)
        identity.rovers.push_back("a-board-with-a-name-as-long-as-a-name-of-a-service-may-be-here-" +
                                  std::to_string(i % 10));
    for (std::size_t i = 0; i < identity.rovers.size(); ++i)
        identity.rovers[i].replace(0, 2, std::to_string(10 + i));
    member_.emplace(bus::Topics(), identity, world_, random_);
    connect();
    pass(1500ms);
    const auto description = model::parse_description(last("asip/servicebus/world/$description"));
    ASSERT_TRUE(description) << description.error();
    EXPECT_THAT(description->services, SizeIs(kMaxPublishedRovers + 1));
}

TEST_F(WorldMemberTest, Floor_IsSaidAtOnceAndAgainEveryFewSeconds) {
    connect();
    pass(1500ms);
    ASSERT_THAT(floors("line"), SizeIs(1));
    EXPECT_EQ(
        floors("line")[0],
        json::parse(
            R"([{"x":0.0,"y":0.0},{"x":1000.0,"y":0.0},{"x":1000.0,"y":1000.0},{"x":0.0,"y":1000.0}])"));
    EXPECT_EQ(floors("floor")[0], json::parse(R"({"width":19.0,"off":40.0,"radius":90.0,"ahead":60.0})"));
    EXPECT_EQ(floors("obstacles")[0], json::array());
    pass(10s);
    for (const auto* event : {"line", "floor", "obstacles"})
        EXPECT_THAT(floors(event), SizeIs(3)) << event;
}

TEST_F(WorldMemberTest, NewObstacle_IsSaidAtOnceAndAlone) {
    announce();
    world_->block({{700, -490.04}, 60});
    pass(60ms);
    ASSERT_THAT(floors("obstacles"), SizeIs(1));
    EXPECT_EQ(floors("obstacles")[0], json::parse(R"([{"x":700.0,"y":-490.0,"r":60.0}])"));
    EXPECT_THAT(floors("line"), SizeIs(0));
    world_->clear();
    pass(60ms);
    EXPECT_EQ(floors("obstacles").back(), json::array());
}

TEST_F(WorldMemberTest, Obstacles_AreBounded) {
    for (int i = 0; i < 3000; ++i)
        world_->block({{i * 1.0, 5000}, 1});
    connect();
    pass(1500ms);
    ASSERT_THAT(floors("obstacles")[0], SizeIs(1000));
    EXPECT_EQ(floors("obstacles")[0].back()["x"], 2999);
}

TEST_F(WorldMemberTest, MovingRover_IsSaidTwentyTimesASecond) {
    announce();
    pass(2s, kFullPower / 4);
    EXPECT_NEAR(static_cast<double>(poses().size()), 40, 2);
    const auto first = poses().front(), last_pose = poses().back();
    EXPECT_GT(last_pose["x"], first["x"]);
    EXPECT_EQ(last_pose["y"], 0);
    EXPECT_EQ(last_pose["heading"], 0);
    EXPECT_EQ(last_pose["offset"], 0);
    EXPECT_EQ(last_pose["laps"], 0);
    EXPECT_FALSE(last_pose.contains("lap")) << "there was none yet";
}

TEST_F(WorldMemberTest, StandingRover_IsSaidOnceASecond) {
    announce();
    pass(5s);
    EXPECT_NEAR(static_cast<double>(poses().size()), 5, 1);
}

TEST_F(WorldMemberTest, RoverThatWasPutAside_SaysItsOffsetAtOnce) {
    announce();
    world_->place(rover_, {{300, 30}, 0});
    pass(60ms);
    ASSERT_THAT(poses(), SizeIs(testing::Ge(1)));
    EXPECT_EQ(poses().back()["y"], 30);
    EXPECT_EQ(poses().back()["offset"], 30);
}

TEST_F(WorldMemberTest, SlowBroker_GetsTheNewestAndNothingOlder) {
    announce();
    pass(3s, kFullPower / 4, false);
    EXPECT_THAT(poses(), SizeIs(0));
    const auto at = world_->state(rover_).pose.at.x;
    pass(60ms);
    ASSERT_THAT(poses(), SizeIs(1));
    EXPECT_NEAR(poses()[0]["x"].get<double>(), at, 0.1);
}

TEST_F(WorldMemberTest, BrokerThatCameBack_HearsEverythingAnew) {
    announce();
    member().on_disconnected();
    pass(3s, kFullPower / 4);
    EXPECT_THAT(said_, SizeIs(0));
    connect();
    pass(100ms);
    EXPECT_EQ(last("asip/servicebus/world/$state"), "online");
    EXPECT_THAT(floors("line"), SizeIs(1));
    EXPECT_THAT(poses(), SizeIs(1));
}

TEST_F(WorldMemberTest, Command_IsRefused) {
    announce();
    for (const auto* topic : {"asip/world/mirto/in", "asip/world/floor/in", "asip/world/in"}) {
        take([&](auto& out) { member().on_message(command(topic), now_, out); });
        EXPECT_THAT(last("me"), HasSubstr(R"("status":"refused")")) << topic;
        EXPECT_THAT(last("me"), HasSubstr(R"("id":"7")"));
        said_.clear();
    }
    auto retained = command("asip/world/mirto/in");
    retained.retain = true;
    take([&](auto& out) { member().on_message(retained, now_, out); });
    EXPECT_THAT(said_, SizeIs(0));
}

TEST_F(WorldMemberTest, Stop_IsDoneAsNothingRuns) {
    announce();
    take([&](auto& out) { member().on_message(command("asip/world/$stop"), now_, out); });
    EXPECT_THAT(last("me"), HasSubstr(R"("status":"ok")"));
    EXPECT_THAT(last("me"), HasSubstr(R"("executed":[])"));
}

TEST_F(WorldMemberTest, End_SaysOfflineAndWillSaysLost) {
    announce();
    take([&](auto& out) { member().goodbye(now_, out); });
    EXPECT_EQ(last("asip/servicebus/world/$state"), "offline");
    EXPECT_EQ(member().will().payload, "lost");
}

TEST(Outline, CurveOfManyPoints_KeepsItsShapeWithFew) {
    std::vector<world::Point> circle;
    for (int i = 0; i < 10'000; ++i)
        circle.push_back(500 * world::direction(i * 2 * std::numbers::pi / 10'000));
    const auto few = world::outline(circle, 400);
    EXPECT_LT(few.size(), 250u);
    const auto track = world::Track::create(few, 19).value();
    for (const auto& point : circle)
        ASSERT_LT(std::abs(track.nearest(point).offset), 0.16);
}

TEST(Outline, LineThatIsAllCorners_IsBounded) {
    std::vector<world::Point> comb;
    for (int i = 0; i < 10'000; ++i)
        comb.push_back({i * 2.0, i % 2 * 300.0});
    const auto few = world::outline(comb, 400);
    EXPECT_LE(few.size(), 400u);
    EXPECT_EQ(few.front(), comb.front());
    EXPECT_EQ(few.back(), comb.back());
}

}  // namespace
}  // namespace asip::sim
