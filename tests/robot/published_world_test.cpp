// SPDX-License-Identifier: Apache-2.0
// asip-sim --publish-world: the floor and the rovers of simulated boards, on a real broker.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>

#include "asip/program/exit_status.hpp"
#include "live_rovers.hpp"
#include "tests/support/bus_probe.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr auto kStateTopic = "asip/servicebus/world/$state";
constexpr auto kPoseTopic = "asip/world/mirto0/out";

/// asip-sim with one rover, and its world on the bus.
class PublishedWorld : public testing::Test {
  protected:
    std::unique_ptr<ChildProcess> start_world(const std::vector<std::string>& options = {}) {
        auto words = rovers_on_one_line(folder_, 1, 3000);
        words.insert(words.begin(), options.begin(), options.end());
        words.insert(words.begin(),
                     {"asip-sim", "--no-socket", "--publish-world", "world", "--broker", broker_.url()});
        auto started = program(std::move(words));
        EXPECT_TRUE(started->wait_for_output(" port ")) << started->errors();
        return started;
    }

    /// The first pose, received or to come, of which this is true.
    static bool saw_pose(const BusProbe& probe, const std::function<bool(const json&)>& match) {
        return probe
            .wait_for([&](const mqtt::Message& message) {
                return message.topic == kPoseTopic && match(json::parse(message.payload)["pose"]);
            })
            .has_value();
    }
    static bool saw_pose_at(const BusProbe& probe, double x, double y) {
        return saw_pose(probe, [=](const json& pose) { return pose["x"] == x && pose["y"] == y; });
    }

    TempDir folder_;
    MosquittoBroker broker_;
};

TEST_F(PublishedWorld, FloorAndDrivingRover_AreSeen) {
    BusProbe probe(broker_.port());
    const auto world = start_world();
    ASSERT_TRUE(probe.wait_for(kStateTopic, "online")) << world->errors();
    const auto line = probe.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/world/floor/out" &&
               message.payload.find("\"line\"") != std::string::npos;
    });
    ASSERT_TRUE(line);
    EXPECT_GT(json::parse(line->payload)["line"].size(), 20u);
    ASSERT_TRUE(saw_pose_at(probe, -60, 0));

    const auto bridge = agent(broker_, folder_.file("mirto0"), "mirto0");
    ASSERT_TRUE(probe.wait_for("asip/servicebus/mirto0/$state", "online")) << bridge->errors();
    const auto answer = probe.request("asip/mirto0/motors/in", R"({"drive":[60,-60]})");
    ASSERT_TRUE(answer);
    ASSERT_THAT(*answer, HasSubstr("\"ok\""));
    EXPECT_TRUE(saw_pose(probe, [](const json& pose) { return pose["x"] > 60; })) << "it does not drive";
    const auto poses = probe.messages(kPoseTopic);
    const auto between = std::count_if(poses.begin(), poses.end(), [](const mqtt::Message& message) {
        const double x = json::parse(message.payload)["pose"]["x"];
        return x > -50 && x < 50;
    });
    EXPECT_GE(between, 5) << "100 mm take at least a second";
}

TEST_F(PublishedWorld, CommandAndStop_AreAnswered) {
    BusProbe probe(broker_.port());
    const auto world = start_world();
    ASSERT_TRUE(probe.wait_for(kStateTopic, "online")) << world->errors();
    EXPECT_THAT(probe.request("asip/world/mirto0/in", R"({"report":100})").value_or(""),
                HasSubstr("\"refused\""));
    EXPECT_THAT(probe.request("asip/world/$stop", "").value_or(""), HasSubstr("\"ok\""));
}

TEST_F(PublishedWorld, BrokerThatDies_LeavesTheBoardsAloneAndHearsOfThemAgain) {
    const auto world = start_world();
    {
        const BusProbe probe(broker_.port());
        ASSERT_TRUE(saw_pose_at(probe, -60, 0)) << world->errors();
    }
    broker_.kill();
    world->write_input("place rover 500 20 0\nblock rover 700 -490 60\n");
    ASSERT_TRUE(world->wait_for_errors("no connection")) << world->errors();
    ASSERT_TRUE(world->wait_for_output("rover at 500,20")) << world->output();
    broker_.start();
    const BusProbe probe(broker_.port());
    EXPECT_TRUE(saw_pose_at(probe, 500, 20)) << world->errors();
    EXPECT_TRUE(probe.wait_for("asip/world/floor/out", R"({"obstacles":[{"x":700.0,"y":-490.0,"r":60.0}]})"));
    EXPECT_TRUE(probe.wait_for(kStateTopic, "online"));
    EXPECT_TRUE(world->running());
}

TEST_F(PublishedWorld, End_SaysOffline_AndDeathSaysLost) {
    const BusProbe probe(broker_.port());
    auto world = start_world();
    ASSERT_TRUE(probe.wait_for(kStateTopic, "online")) << world->errors();
    world->signal(SIGTERM);
    EXPECT_EQ(world->wait_exit(), 0);
    ASSERT_TRUE(probe.wait_for(kStateTopic, "offline"));

    world = start_world();
    ASSERT_TRUE(
        wait_until([&] { return probe.count(kPoseTopic) > 0 && probe.last(kStateTopic) == "online"; }));
    world->signal(SIGKILL);
    EXPECT_TRUE(probe.wait_for(kStateTopic, "lost"));
}

TEST_F(PublishedWorld, NameThatIsTaken_IsReportedAndTheBoardsRunOn) {
    const BusProbe probe(broker_.port());
    const auto first = start_world();
    ASSERT_TRUE(probe.wait_for(kStateTopic, "online")) << first->errors();
    const auto second = start_world({"--link", folder_.file("second")});
    ASSERT_TRUE(second->wait_for_errors("the world is not published.*is held by")) << second->errors();
    second->write_input("place rover 500 20 0\n");
    EXPECT_TRUE(second->wait_for_output("rover at 500,20"));
    second->signal(SIGTERM);
    EXPECT_EQ(second->wait_exit(), 0);
    EXPECT_EQ(probe.last(kStateTopic), "online");
}

TEST_F(PublishedWorld, WhatCannotBePublished_IsRefusedWithAReason) {
    const auto refusal = [&](const std::string& name, std::vector<std::string> boards) {
        std::vector<std::string> words{ASIP_PROGRAMS "/asip-sim", "--no-socket", "--publish-world", name};
        words.insert(words.end(), boards.begin(), boards.end());
        const auto ended = run(words);
        EXPECT_EQ(ended.status, program::kExitUsage) << ended.errors;
        return ended.errors;
    };
    const auto board = [&](const std::string& name, const std::string& world) {
        json document{{"name", name}, {"image", ASIP_MIRTO}};
        if (!world.empty()) {
            document["world"] = world;
            document["parts"] = {{{"kind", "rover"}}};
        }
        return folder_.write(name + ".json", document.dump());
    };
    const auto other = folder_.write("other-world.json", R"({"track":{"line":[[0,0],[900,0],[0,900]]}})");
    EXPECT_THAT(refusal("a/b", {board("one", ASIP_TRACK)}), HasSubstr("--publish-world: 'a/b'"));
    EXPECT_THAT(refusal("one", {board("one", ASIP_TRACK)}), HasSubstr("a board is called one too"));
    EXPECT_THAT(refusal("world", {board("bare", "")}), HasSubstr("no board has a world"));
    EXPECT_THAT(refusal("world", {board("one", ASIP_TRACK), board("two", other)}),
                HasSubstr("have 2 worlds"));
    EXPECT_THAT(refusal("world", {board("floor", ASIP_TRACK)}), HasSubstr("called floor"));
    EXPECT_THAT(refusal("world", {board("a+b", ASIP_TRACK)}), HasSubstr("board a+b would be a service"));
}

}  // namespace
}  // namespace asip::test
