// SPDX-License-Identifier: Apache-2.0
// Robots in real time, with everything real between world and line follower.
#include <gtest/gtest.h>

#include <csignal>

#include "live_rovers.hpp"
#include "tests/support/bus_probe.hpp"

namespace asip::test {
namespace {

TEST(LiveRovers, ThreeInOneWorldOnOneBroker_EachDrivesItsLap) {
    const TempDir folder;
    const MosquittoBroker broker;
    auto words = rovers_on_one_line(folder, 3, 3000);
    words.insert(words.begin(), {"asip-sim", "--no-socket"});
    const auto world = program(words);
    std::vector<std::unique_ptr<ChildProcess>> agents, followers;
    const std::string names[] = {"mirto0", "mirto1", "mirto2"};
    for (const auto& name : names) {
        ASSERT_TRUE(world->wait_for_output(name + " .*port ")) << world->errors();
        agents.push_back(agent(broker, folder.file(name), name));
    }
    // Slower than usual: the test has to hold on a machine that three simulated boards keep busy
    for (const auto& name : names)
        followers.push_back(program({"example-line_follower", broker.url() + "/" + name, "--power", "35"}));
    bool laps = true;
    for (const auto& name : names)
        laps = laps && world->wait_for_output(name + " .* rover lap ", std::chrono::seconds(90)).has_value();
    const bool kept = laps && world->output().find("off-track") == std::string::npos &&
                      world->output().find("bump") == std::string::npos;
    if (!kept && world->output().find(" behind ") != std::string::npos)
        GTEST_SKIP() << "this machine is too busy for three boards in real time";
    EXPECT_TRUE(kept) << world->output();
}

TEST(LiveRovers, FollowerThatIsTold_LeavesTheRobotStanding) {
    const TempDir folder;
    const MosquittoBroker broker;
    auto words = rovers_on_one_line(folder, 1, 3000);
    words.insert(words.begin(), {"asip-sim", "--no-socket"});
    const auto world = program(words);
    ASSERT_TRUE(world->wait_for_output(" port ")) << world->errors();
    const auto bridge = agent(broker, folder.file("mirto0"), "mirto0");
    BusProbe probe(broker.port());
    const auto follower = program({"example-line_follower", broker.url() + "/mirto0"});
    ASSERT_TRUE(follower->wait_for_output("follows the line")) << follower->errors();
    ASSERT_TRUE(probe.wait_for("asip/mirto0/reflectance/out"));
    EXPECT_EQ(probe.request("asip/mirto0/encoders/in", R"({"report":100})").has_value(), true);
    ASSERT_TRUE(probe.wait_for([](const mqtt::Message& message) {
        if (message.topic != "asip/mirto0/encoders/out") return false;
        return nlohmann::json::parse(message.payload)["encoders"][0]["count"] > 1;
    })) << "it does not drive";
    follower->signal(SIGTERM);
    EXPECT_EQ(follower->wait_exit(), 0);
    probe.clear();
    EXPECT_TRUE(probe.wait_for([](const mqtt::Message& message) {
        if (message.topic != "asip/mirto0/encoders/out") return false;
        const auto wheels = nlohmann::json::parse(message.payload)["encoders"];
        return wheels[0]["count"] == 0 && wheels[1]["count"] == 0;
    }));
}

}  // namespace
}  // namespace asip::test
