// SPDX-License-Identifier: Apache-2.0
// The rover part on a board with the image of AsipMirto, line by line.
#include <gmock/gmock.h>

#include <cstdio>

#include "sim/board.hpp"
#include "sim/world/world_file.hpp"

namespace asip::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kStraight =
    R"({"track":{"line":[[0,0],[5000,0],[5000,100],[0,100]]},"rover":{"lag_ms":0}})";

std::shared_ptr<sim::world::World> made(std::string_view floor) {
    auto world = sim::world::parse_world(floor, "world");
    if (!world) throw std::runtime_error(world.error());
    return *world;
}

class Mirto {
  public:
    explicit Mirto(nlohmann::json part = nlohmann::json::object(), std::string_view floor = kStraight)
        : world(made(floor)) {
        sim::BoardConfig config;
        config.image = ASIP_MIRTO;
        config.parts = {{"rover", std::move(part), "rover"}};
        config.world = world;
        auto created = sim::Board::create(config);
        if (!created) throw std::runtime_error(created.error());
        board = std::move(*created);
        board->on_change([this](const sim::Change& change) { events.push_back(change.value); });
        board->read_line(1s);
        ask("I,A,0");
    }

    void ask(const std::string& line) {
        board->send(line + "\n");
        board->run_for(20ms);
    }
    /// The first event of this service from now on.
    std::string event(char service) {
        board->take_output();
        for (int i = 0; i < 50; ++i)
            if (const auto line = board->read_line(100ms);
                line && line->text.starts_with(std::string("@") + service))
                return line->text;
        return "(none)";
    }

    std::shared_ptr<sim::world::World> world;
    std::unique_ptr<sim::Board> board;
    std::vector<std::string> events;
};

TEST(RoverPart, PowersAsPublished_DriveForwardsWithBothEncodersAgreeing) {
    Mirto mirto;
    mirto.ask("M,M,128,-128");
    const auto before = mirto.world->state(0);
    mirto.ask("E,A,1000");
    long pulse[2] = {0, 0}, steps[2] = {0, 0};
    const auto line = mirto.event('E');
    ASSERT_EQ(
        std::sscanf(line.c_str(), "@E,e,2,{%ld:%ld,%ld:%ld}", &pulse[0], &steps[0], &pulse[1], &steps[1]), 4)
        << line;
    const auto after = mirto.world->state(0);
    // A turn a second at half of 120 rpm; 32 cycles and 64 steps a turn
    EXPECT_NEAR(after.wheels[0].speed, 128 / 255.0 * 4 * 3.14159, 0.001);
    EXPECT_NEAR(static_cast<double>(pulse[0]), 1e6 / 64 * 127.5 / 128, 20);
    EXPECT_EQ(pulse[0], pulse[1]);
    EXPECT_NEAR(static_cast<double>(steps[0]), 64 * 128 / 127.5 * 1.02, 3);
    EXPECT_EQ(steps[1], steps[0]) << "as ASIP 0.4 counts them";
    EXPECT_GT(after.pose.at.x, before.pose.at.x + 180);
    EXPECT_NEAR(after.pose.at.y, before.pose.at.y, 0.001);
}

TEST(RoverPart, Encoders_CountWhatTheWheelsTurnedToTheStep) {
    Mirto mirto(
        nlohmann::json::object(),
        R"({"track":{"line":[[0,0],[5000,0],[5000,100]]},"rover":{"encoder_cycles":2000,"slip":0.3}})");
    for (const char* request : {"M,M,255,-255", "M,M,-100,-180", "M,m,1,60", "M,S"})
        mirto.ask(request), mirto.board->run_for(300ms);
    mirto.board->run_for(600ms);  // until they stand
    mirto.ask("E,A,50");
    long steps[2] = {0, 0};
    const auto line = mirto.event('E');
    ASSERT_EQ(std::sscanf(line.c_str(), "@E,e,2,{%*d:%ld,%*d:%ld}", &steps[0], &steps[1]), 2) << line;
    const auto wheels = mirto.world->state(0).wheels;
    EXPECT_NEAR(static_cast<double>(steps[0]), wheels[0].turned / (2 * 3.14159265) * 4000, 1);
    EXPECT_NEAR(static_cast<double>(steps[1]), wheels[1].turned / (2 * 3.14159265) * 4000, 1);
}

TEST(RoverPart, Reflectance_IsSeenWhileTheEmittersAreOn) {
    Mirto mirto(nlohmann::json{{"start", 300}});
    mirto.ask("R,A,50");
    const auto line = mirto.event('R');
    int left = 0, middle = 0, right = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "@R,e,3,{%d,%d,%d}", &right, &middle, &left), 3) << line;
    EXPECT_NEAR(middle, 900, 1);
    EXPECT_EQ(left, right);
    EXPECT_LT(left, 600);
    // The board's own look at a sensor finds the emitters off
    ASSERT_TRUE(mirto.board->part("rover").command("place", "240 10.5 0"));
    const auto aside = mirto.event('R');
    EXPECT_EQ(std::sscanf(aside.c_str(), "@R,e,3,{%d,%d,%d}", &right, &middle, &left), 3);
    EXPECT_NEAR(left, 25, 1);
    EXPECT_NEAR(right, 900, 1);
    EXPECT_EQ(mirto.board->pin(14), sim::Level::kLow);
}

TEST(RoverPart, ObstacleOnTheWay_IsMeasuredAndBumpedInto) {
    Mirto mirto;
    ASSERT_TRUE(mirto.board->part("rover").command("block", "700 0 60"));
    mirto.ask("D,M");
    EXPECT_EQ(mirto.event('D'), "(none)") << "answered before";
    mirto.board->send("D,M\n");
    const auto line = mirto.board->read_line(100ms);
    ASSERT_TRUE(line);
    EXPECT_EQ(line->text, "@D,e,1,{61}");  // 700 - 60 - 90 + 60 from the line's beginning
    mirto.ask("S,W,0,180");
    mirto.board->run_for(100ms);
    mirto.board->send("D,M\n");
    EXPECT_EQ(mirto.board->read_line(100ms)->text, "@D,e,1,{0}") << "nothing to the left";
    mirto.ask("B,A,50");
    EXPECT_EQ(mirto.event('B'), "@B,e,2,{1,1}");
    mirto.ask("M,M,255,-255");
    mirto.board->run_for(3s);
    EXPECT_EQ(mirto.event('B'), "@B,e,2,{0,0}");
    EXPECT_THAT(mirto.events, testing::Contains("bump"));
    EXPECT_THAT(mirto.board->part("rover").state(), HasSubstr("bumped"));
}

TEST(RoverPart, FastestRate_IsRefusedBecauseTheEncodersLeaveTheLineNoTime) {
    Mirto mirto;
    mirto.board->send("#,B,1000000\n");
    EXPECT_EQ(mirto.board->read_line(100ms)->text, "~#,B,11{BAD_ARGUMENT}");
    mirto.board->send("#,B,500000\n");
    EXPECT_EQ(mirto.board->read_line(100ms)->text, "@#,B,500000");
}

TEST(RoverPart, Reset_ComesToRestAndDrivesAgain) {
    Mirto mirto;
    mirto.ask("M,M,200,-200");
    mirto.board->run_for(200ms);
    mirto.board->reset();
    mirto.board->run_for(1s);
    const auto stopped = mirto.world->state(0);
    mirto.board->run_for(100ms);
    EXPECT_EQ(mirto.world->state(0).pose.at, stopped.pose.at);
    mirto.ask("M,M,200,-200");
    mirto.board->run_for(200ms);
    EXPECT_GT(mirto.world->state(0).pose.at.x, stopped.pose.at.x + 10);
}

TEST(RoverPart, LineThatIsLeft_IsToldOnce) {
    Mirto mirto(nlohmann::json{{"start", 300}},
                R"({"track":{"line":[[0,0],[5000,0],[5000,3000],[0,3000]]}})");
    mirto.ask("M,M,80,-120");  // to the left, in a circle of 600 mm
    mirto.board->run_for(2s);
    EXPECT_EQ(std::count(mirto.events.begin(), mirto.events.end(), "off-track"), 1);
    EXPECT_THAT(mirto.board->part("rover").state(), HasSubstr("off-track"));
}

TEST(RoverPart, WrongCommand_IsRefusedWithWhatIsRight) {
    Mirto mirto;
    auto& rover = mirto.board->part("rover");
    EXPECT_THAT(rover.command("place", "1 2").error(), HasSubstr("place rover 0 0 90"));
    EXPECT_THAT(rover.command("place", "1 2 3 4").error(), HasSubstr("place rover 0 0 90"));
    EXPECT_THAT(rover.command("block", "1 2 0").error(), HasSubstr("block rover 300 0 50"));
    EXPECT_THAT(rover.command("picture", "/nowhere/x.svg").error(), HasSubstr("cannot be written"));
    EXPECT_THAT(rover.command("picture", "/nowhere/x.png").error(), HasSubstr("a picture is SVG"));
    ASSERT_TRUE(rover.command("place", "100 -50 -90"));
    EXPECT_THAT(rover.state(), StartsWith("at 100,-50 heading 270"));
}

TEST(RoverPart, BoardWithoutAWorld_IsRefused) {
    sim::BoardConfig config;
    config.image = ASIP_MIRTO;
    config.parts = {{"rover", nlohmann::json::object(), "rover"}};
    EXPECT_THAT(sim::Board::create(config).error(), HasSubstr("/parts/0: needs a world"));
    config.world = sim::world::parse_world(kStraight, "world").value();
    config.parts[0].settings["encoders"] = {1, 2};
    EXPECT_THAT(sim::Board::create(config).error(), HasSubstr("/parts/0/encoders: is a list of 4 pins"));
}

}  // namespace
}  // namespace asip::test
