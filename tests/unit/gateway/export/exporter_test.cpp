// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exporter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "export_world.hpp"

namespace asip::gateway::exports {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr const char* kDocument = "homeassistant/device/asip-uno1/config";
constexpr const char* kState = "asip/export/ha/$state";
constexpr const char* kBoard = "asip/export/ha/uno1/$state";
constexpr const char* kDistance = "asip/export/ha/uno1/distance-0";
constexpr const char* kServo = "asip/export/ha/uno1/servo-0-angle";
constexpr const char* kGateway = "asip/export/ha/$gateway";
constexpr const char* kGatewayDocument = "homeassistant/device/asip_gateway/config";
constexpr const char* kError = "asip/export/ha/uno1/last-error";

class ExporterTest : public testing::Test {
  protected:
    std::set<std::string> topics() const {
        std::set<std::string> result;
        for (const auto& [topic, payload] : world.retained)
            if (topic != "asip/export/ha/$lease" && topic != "asip/export/ha/$sessions" &&
                topic != kGateway && topic != kGatewayDocument)
                result.insert(topic);
        return result;
    }
    std::size_t boards_shown() const { return world.devices.size() - world.devices.count(kGatewayDocument); }
    ExportWorld world;
};

TEST_F(ExporterTest, BoardIsExported_WithDocumentAvailabilityAndValues) {
    world.put("uno1", exported(1));
    world.value("uno1", "distance", R"({"distance":[42]})");
    world.known("uno1", "servo/0/angle", 90);
    world.start();
    world.pass(3s);
    EXPECT_THAT(topics(), UnorderedElementsAre(kDocument, kState, kBoard, kDistance, kServo));
    EXPECT_EQ(world.retained[kState], "online");
    EXPECT_EQ(world.retained[kBoard], "online");
    EXPECT_EQ(world.retained[kDistance], "42");
    EXPECT_EQ(world.retained[kServo], "90");
    EXPECT_THAT(world.devices[kDocument],
                UnorderedElementsAre("sensor distance-0", "number servo-0-angle", "sensor last-error"));
    for (const auto* topic : {kDocument, kBoard, kDistance, kServo, kState})
        EXPECT_EQ(world.times_sent(topic), 1u) << topic;
}

TEST_F(ExporterTest, Gateway_IsADeviceWithDiagnostics) {
    world.put("uno1", exported(1));
    world.put("uno2", exported(1));
    world.start();
    world.pass(3s);
    EXPECT_THAT(world.devices[kGatewayDocument],
                UnorderedElementsAre("binary_sensor connection", "sensor boards"));
    EXPECT_EQ(world.retained[kGateway], R"({"boards":2})");
    world.boards["uno1"].there = false;
    world.changed("uno1");
    world.pass(1s);
    EXPECT_EQ(world.retained[kGateway], R"({"boards":1})");
    world.boards.erase("uno2");
    world.changed("uno2");
    world.pass(1s);
    EXPECT_EQ(world.retained[kGateway], R"({"boards":0})");
    EXPECT_EQ(world.times_sent(kGatewayDocument), 1u);
    world.publish(kGateway, "", true);
    world.pass(2s);
    EXPECT_EQ(world.retained[kGateway], R"({"boards":0})") << "what somebody empties is there again";
}

TEST_F(ExporterTest, BoardThatIsLost_IsNotAvailable_AndIsWhenItIsBack) {
    world.put("uno1", exported(1));
    world.start();
    world.pass(3s);
    world.boards["uno1"].there = false;
    world.changed("uno1");
    EXPECT_EQ(world.retained[kBoard], "offline");
    world.boards["uno1"].there = true;
    world.changed("uno1");
    EXPECT_EQ(world.retained[kBoard], "online");
    EXPECT_EQ(world.times_sent(kDocument), 1u);
}

TEST_F(ExporterTest, BoardThatIsForgotten_LeavesNothing) {
    world.put("uno1", exported(2));
    world.start();
    world.pass(3s);
    world.value("uno1", "distance", R"({"distance":[42,43]})");
    world.forget("uno1");
    EXPECT_THAT(topics(), UnorderedElementsAre(kState));
    EXPECT_EQ(boards_shown(), 0u);
}

// A turn as long as all of them would delay each request over HTTP.
TEST_F(ExporterTest, ManyBoards_AreLookedAtAFewInATurn) {
    for (int i = 0; i < 100; ++i)
        world.put("uno" + std::to_string(i), exported(1));
    world.publish("asip/export/ha/gone/distance-0", "1", true);
    auto& first = world.start();
    world.pass(10s);
    EXPECT_EQ(boards_shown(), 100u);
    EXPECT_FALSE(world.retained.contains("asip/export/ha/gone/distance-0"));
    world.kill(first);
    world.publish("asip/export/ha/gone/distance-0", "1", true);
    world.start();
    world.pass(120s);
    EXPECT_FALSE(world.retained.contains("asip/export/ha/gone/distance-0"));
    EXPECT_EQ(world.times_sent(kDocument), 1u);
    EXPECT_EQ(world.retained[kBoard], "online");
    EXPECT_LE(world.most_looks, Exporter::kBoardsAtOnce);
}

TEST_F(ExporterTest, ManyBoardsChangeAtOnce_AreLookedAtAFewInATurn) {
    std::set<std::string> names;
    for (int i = 0; i < 100; ++i)
        world.put(*names.insert("uno" + std::to_string(i)).first, exported(1));
    world.start();
    world.pass(10s);
    for (auto& [name, board] : world.boards)
        board.there = false;
    world.changed(names);
    world.pass(10s);
    for (const auto& name : names)
        EXPECT_EQ(world.retained["asip/export/ha/" + name + "/$state"], "offline") << name;
    EXPECT_LE(world.most_looks, Exporter::kBoardsAtOnce);
}

TEST_F(ExporterTest, ValueThatIsNone_IsUnknown) {
    world.put("uno1", exported(1));
    world.start();
    world.pass(3s);
    world.value("uno1", "distance", R"({"distance":[null]})");
    EXPECT_EQ(world.retained[kDistance], "None");
}

TEST_F(ExporterTest, ValueThatThePropertyCannotHave_IsCountedAndNotSent) {
    auto board = exported(1);
    board.properties[0].min = 2;
    board.properties[0].max = 400;
    world.put("uno1", board);
    world.start();
    world.pass(3s);
    world.value("uno1", "distance", R"({"distance":[42]})");
    world.value("uno1", "distance", R"({"distance":[1]})");
    world.value("uno1", "distance", R"({"distance":["far"]})");
    world.pass(1s);
    EXPECT_EQ(world.retained[kDistance], "42");
    EXPECT_EQ(world.refused, 2u);
    world.value("uno1", "distance", R"({"distance":[43]})");
    EXPECT_EQ(world.retained[kDistance], "43");
}

TEST_F(ExporterTest, WhatWasSet_IsUnknownBehindARestartOfTheBoard) {
    world.put("uno1", exported(1));
    auto& gateway = world.start();
    world.pass(3s);
    world.known("uno1", "servo/0/angle", std::nullopt);
    EXPECT_EQ(world.times_sent(kServo), 0u) << "nothing was said before";
    world.known("uno1", "servo/0/angle", 90);
    world.pass(1s);
    world.known("uno1", "servo/0/angle", std::nullopt);
    world.pass(1s);
    EXPECT_EQ(world.retained[kServo], "None");
    EXPECT_TRUE(gateway.commands.empty());
}

TEST_F(ExporterTest, Command_IsSentAndChangesNothingBeforeItsProof) {
    world.put("uno1", exported(1));
    auto& gateway = world.start();
    world.pass(3s);
    world.publish(std::string(kServo) + "/set", "90");
    world.step();
    ASSERT_EQ(gateway.commands.size(), 1u);
    EXPECT_EQ(gateway.commands[0],
              (std::pair<std::string, Request>{"uno1", {"servo", R"({"write":[0,90]})"}}));
    gateway.answers[0]("");
    world.pass(1s);
    EXPECT_FALSE(world.retained.contains(kServo));
    EXPECT_FALSE(world.retained.contains(kError));
}

TEST_F(ExporterTest, CommandThatFails_IsTheLastErrorOfTheBoard) {
    world.put("uno1", exported(1));
    auto& gateway = world.start();
    world.pass(3s);
    world.publish(std::string(kServo) + "/set", "90");
    world.step();
    gateway.answers.at(0)("the board says: INVALID_DEVICE_NUMBER");
    world.pass(1s);
    EXPECT_EQ(world.retained[kError], "Servo angle: the board says: INVALID_DEVICE_NUMBER");
    EXPECT_FALSE(world.retained.contains(kServo));
    world.publish(std::string(kServo) + "/set", "181");
    world.pass(1s);
    EXPECT_EQ(world.retained[kError], "Servo angle cannot be set to 181");
    world.boards["uno1"].there = false;
    world.changed("uno1");
    world.publish(std::string(kServo) + "/set", "90");
    world.pass(1s);
    EXPECT_EQ(world.retained[kError], "Servo angle: the board is not there");
    EXPECT_EQ(gateway.commands.size(), 1u);
}

TEST_F(ExporterTest, CommandThatThePropertyRefuses_IsTheLastErrorAndNotSent) {
    auto board = exported(1);
    for (auto& each : board.properties)
        each.refused = each.settable() ? "a command made pin 9 an input" : "";
    world.put("uno1", board);
    auto& gateway = world.start();
    world.pass(3s);
    world.publish(std::string(kServo) + "/set", "90");
    world.pass(1s);
    EXPECT_EQ(world.retained[kError], "a command made pin 9 an input");
    EXPECT_TRUE(gateway.commands.empty());
    world.put("uno1", exported(1));
    world.changed("uno1");
    world.pass(3s);
    world.publish(std::string(kServo) + "/set", "90");
    world.pass(1s);
    EXPECT_EQ(gateway.commands.size(), 1u);
}

TEST_F(ExporterTest, RetainedCommand_IsNeverExecutedAndCleared) {
    world.put("uno1", exported(1));
    world.publish(std::string(kServo) + "/set", "90", true);
    auto& gateway = world.start();
    world.pass(5s);
    EXPECT_TRUE(gateway.commands.empty());
    EXPECT_FALSE(world.retained.contains(std::string(kServo) + "/set"));
}

TEST_F(ExporterTest, CommandForWhatIsNotThere_IsLogged) {
    world.put("uno1", exported(1, false));
    auto& gateway = world.start();
    world.pass(3s);
    for (const auto* topic : {"asip/export/ha/uno1/servo-0-angle/set", "asip/export/ha/uno2/x/set"})
        world.publish(topic, "90");
    world.pass(1s);
    EXPECT_TRUE(gateway.commands.empty());
    EXPECT_THAT(gateway.log, testing::Contains(HasSubstr("uno2/x, which is not there")));
}

TEST_F(ExporterTest, ServiceThatIsRemoved_GoesByItsPlatformAloneFirst) {
    world.put("uno1", exported(2));
    world.start();
    world.pass(3s);
    world.value("uno1", "distance", R"({"distance":[1,2]})");
    world.put("uno1", exported(1, false));
    world.pass(5s);
    EXPECT_THAT(world.devices[kDocument], UnorderedElementsAre("sensor distance-0"));
    EXPECT_EQ(world.times_sent(kDocument), 3u);
    EXPECT_THAT(topics(), UnorderedElementsAre(kDocument, kState, kBoard, kDistance));
}

TEST_F(ExporterTest, ServiceThatIsBackAtOnce_HasItsValue) {
    world.put("uno1", exported(1));
    world.start();
    world.pass(3s);
    world.value("uno1", "distance", R"({"distance":[1]})");
    world.put("uno1", exported(0));
    world.put("uno1", exported(1));
    world.pass(5s);
    EXPECT_EQ(world.retained[kDistance], "1");
}

TEST_F(ExporterTest, BoardThatIsForgottenWhileTheBusIsReadBack_ComesBackWhole) {
    world.put("uno1", exported(1));
    world.start();
    world.pass(3s);
    world.restart_home_assistant();
    world.pass(1s);
    world.forget("uno1");
    world.pass(3s);
    EXPECT_FALSE(world.retained.contains(kDocument));
    world.put("uno1", exported(1));
    world.pass(3s);
    EXPECT_TRUE(world.retained.contains(kDocument));
}

TEST_F(ExporterTest, BoardThatComesBackWhileOldTopicsAreCleared_IsShownAnew) {
    world.echoes = false;
    for (int i = 0; i < 500; ++i)
        world.put("b" + std::to_string(i), exported(1));
    world.put("uno1", exported(1));
    world.value("uno1", "distance", R"({"distance":[42]})");
    world.start();
    world.pass(60s);
    ASSERT_EQ(world.retained[kDistance], "42");
    auto uno = world.boards.extract("uno1");
    world.restart_broker(true);
    world.between_turns = [&] {
        // Boards were looked at, and topics are.
        if (uno && world.looks == 0 && world.most_looks > 0) world.boards.insert(std::move(uno));
    };
    world.most_looks = 0;
    world.pass(60s);
    EXPECT_TRUE(world.boards.contains("uno1"));
    EXPECT_EQ(world.retained[kGateway], R"({"boards":501})");
    EXPECT_TRUE(world.retained.contains(kDocument));
    EXPECT_EQ(world.retained[kBoard], "online");
    EXPECT_EQ(world.retained[kDistance], "42");
}

TEST_F(ExporterTest, DocumentThatChangesOften_IsSentEveryTwoSecondsAtMost) {
    world.put("uno1", exported(1));
    world.start();
    world.pass(3s);
    world.sent.clear();
    for (int i = 0; i < 100; ++i) {
        world.put("uno1", exported(1, true, "Desk " + std::to_string(i)));
        world.step();
    }
    world.pass(3s);
    EXPECT_LE(world.times_sent(kDocument), 7u);
    EXPECT_THAT(world.retained[kDocument], HasSubstr("Desk 99"));
}

TEST_F(ExporterTest, HomeAssistantStarts_AndWhatWasDeletedIsThereAgain) {
    world.put("uno1", exported(1));
    world.start();
    world.pass(3s);
    world.value("uno1", "distance", R"({"distance":[42]})");
    world.sent.clear();
    world.restart_home_assistant();
    world.pass(3s);
    EXPECT_EQ(world.times_sent(kDocument), 0u) << "the broker has it";
    for (const auto* topic : {kDocument, kDistance, kBoard})
        world.retained.erase(topic);
    world.restart_home_assistant();
    world.pass(3s);
    EXPECT_EQ(world.times_sent(kDocument), 1u);
    EXPECT_EQ(world.retained[kDistance], "42");
    EXPECT_EQ(world.retained[kBoard], "online");
    EXPECT_EQ(world.devices[kDocument].size(), 3u);
}

TEST_F(ExporterTest, GatewayStartsAgain_AndSendsNothingTwice) {
    world.put("uno1", exported(1));
    world.value("uno1", "distance", R"({"distance":[42]})");
    auto& first = world.start();
    world.pass(3s);
    world.kill(first);
    EXPECT_EQ(world.retained[kState], "offline");
    world.sent.clear();
    world.start();
    world.pass(3s);
    EXPECT_EQ(world.retained[kState], "online");
    for (const auto* topic : {kDocument, kDistance, kBoard})
        EXPECT_EQ(world.times_sent(topic), 0u) << topic;
}

TEST_F(ExporterTest, BrokerWithoutMemory_IsToldEverythingAgain) {
    world.put("uno1", exported(1));
    world.value("uno1", "distance", R"({"distance":[42]})");
    world.start();
    world.pass(3s);
    const auto before = topics();
    world.restart_broker(false);
    world.pass(12s);
    EXPECT_EQ(topics(), before);
    EXPECT_EQ(world.retained[kDistance], "42");
}

TEST_F(ExporterTest, GatewayEnds_AndNothingIsAvailable) {
    world.put("uno1", exported(1));
    auto& gateway = world.start();
    world.pass(3s);
    world.end(gateway);
    EXPECT_EQ(world.retained[kState], "offline");
}

TEST_F(ExporterTest, OptionThatIsTakenAway_ClearsWhatThisMachineExported) {
    world.put("uno1", exported(2));
    world.value("uno1", "distance", R"({"distance":[1,2]})");
    world.end(world.start());
    world.gateways.clear();
    world.pass(3s);
    auto& first = world.start();
    world.pass(3s);
    world.kill(first);
    auto options = world.options();
    options.enabled = false;
    options.host = "another machine";
    world.start(options);
    world.pass(20s);
    EXPECT_EQ(boards_shown(), 1u) << "of another machine's gateway";
    options.host = "host";
    auto& last = world.start(options);
    world.pass(20s);
    EXPECT_TRUE(last.exporter->finished());
    EXPECT_TRUE(world.retained.empty()) << world.retained.begin()->first;
    EXPECT_EQ(boards_shown(), 0u);
}

TEST_F(ExporterTest, OptionThatIsTakenAway_LeavesAnExportThatLives) {
    world.put("uno1", exported(2));
    world.start();
    world.pass(3s);
    auto options = world.options();
    options.enabled = false;
    world.start(options);
    world.pass(60s);
    EXPECT_EQ(boards_shown(), 1u);
}

TEST_F(ExporterTest, AnotherPrefix_ClearsTheOldOne) {
    world.put("uno1", exported(1));
    world.kill(world.start());
    auto& first = world.start();
    world.pass(3s);
    world.kill(first);
    world.publish("elsewhere/device/other/config", "{}", true);
    auto options = world.options();
    options.dialect = ExportWorld::home_assistant("elsewhere");
    world.start(options);
    world.pass(10s);
    EXPECT_FALSE(world.retained.contains(kDocument));
    EXPECT_TRUE(world.retained.contains("elsewhere/device/asip-uno1/config"));
    EXPECT_TRUE(world.retained.contains("elsewhere/device/other/config")) << "of another program";
}

TEST_F(ExporterTest, ManyBoards_WaitForRoom) {
    for (int i = 0; i < 100; ++i)
        world.put("uno" + std::to_string(i), exported(1));
    world.room = 2;
    world.start();
    world.pass(5s);
    EXPECT_LT(boards_shown(), 60u);
    world.pass(60s);
    EXPECT_EQ(boards_shown(), 100u);
}

TEST_F(ExporterTest, ManyBoards_AreSentInSlices_AndAStopIsNotBehindThem) {
    constexpr int kBoards = 500;
    for (int i = 0; i < kBoards; ++i)
        world.put("uno" + std::to_string(i), exported(1));
    auto& gateway = world.start();
    while (world.devices.empty())
        world.step();
    EXPECT_LE(boards_shown(), 3 * Exporter::kSlice);
    gateway.exporter->sent(world.now);
    EXPECT_LE(boards_shown(), 4 * Exporter::kSlice);
    world.end(gateway);
    EXPECT_EQ(world.sent.back().topic, kState);
    EXPECT_LE(boards_shown(), 4 * Exporter::kSlice);

    auto& next = world.start();
    world.pass(5s);
    for (int i = 0; i < 2 * kBoards; ++i)
        next.exporter->sent(world.now);
    EXPECT_EQ(boards_shown(), kBoards);
    for (const auto& [topic, device] : world.devices)
        EXPECT_EQ(world.times_sent(topic), 1u) << topic;
}

}  // namespace
}  // namespace asip::gateway::exports
