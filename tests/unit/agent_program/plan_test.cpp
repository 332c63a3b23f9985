// SPDX-License-Identifier: Apache-2.0
#include "agent/program/plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "asip/program/exit_status.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::agent {
namespace {

using testing::HasSubstr;

class PlanFile : public testing::Test {
  protected:
    Expected<Plan> plan(const std::string& content, const std::vector<std::string>& arguments = {}) {
        return plan_of_file(folder.write("boards.conf", content), arguments);
    }
    std::string error(const std::string& content) {
        const auto made = plan(content);
        return made ? "no error" : made.error();
    }

    test::TempDir folder;
};

TEST_F(PlanFile, SectionsBelowCommonLines_EachBoardHasItsOwnAndTheCommonOnes) {
    const auto made = plan(
        "broker = bus:1884\nlease = 30\nlabel = room=lab\n"
        "[asip-registry]\nunheard = of\n"
        "[board porch]\ntcp = 127.0.0.1:5005\nlease = 120\n"
        "[board shed]\nserial = /dev/ttyX9\nlabel = room=shed\nlabel = floor=1\n"
        "[asip-agent]\nstatistics = 1m\n");
    ASSERT_TRUE(made) << made.error();
    ASSERT_EQ(made->boards.size(), 2u);
    EXPECT_TRUE(made->several());
    const auto& porch = made->boards[0].options;
    const auto& shed = made->boards[1].options;
    EXPECT_EQ(made->boards[0].key, "porch");
    EXPECT_EQ(porch.bridge.name, "porch");
    EXPECT_EQ(porch.tcp, "127.0.0.1:5005");
    EXPECT_EQ(porch.bridge.lease_seconds, 120);
    EXPECT_EQ(porch.bridge.labels.labels.at("room"), "lab");
    EXPECT_EQ(porch.mqtt.brokers.at(0).port, 1884);
    EXPECT_EQ(porch.statistics, std::chrono::minutes(1));
    EXPECT_EQ(shed.bridge.lease_seconds, 30);
    EXPECT_EQ(shed.serial, "/dev/ttyX9");
    EXPECT_EQ(shed.bridge.labels.labels.at("room"), "shed");
    EXPECT_EQ(shed.bridge.labels.labels.at("floor"), "1");
    EXPECT_NE(porch.mqtt.client_id, shed.mqtt.client_id);
    EXPECT_EQ(porch.models.all().front(), shed.models.all().front()) << "not one for each board";
}

TEST_F(PlanFile, CommandLine_GoesBeforeTheSections) {
    const auto made = plan("[board a]\ntcp = x:1\nlease = 30\n[board b]\ntcp = x:2\n", {"--lease", "45"});
    ASSERT_TRUE(made) << made.error();
    for (const auto& board : made->boards)
        EXPECT_EQ(board.options.bridge.lease_seconds, 45);
}

TEST_F(PlanFile, BoardWithoutName_IsKnownByItsPort) {
    const auto made = plan("[board]\ntcp = x:1\n[ board ]\nserial = /dev/ttyX9\n");
    ASSERT_TRUE(made) << made.error();
    EXPECT_EQ(made->boards[0].options.bridge.name, "");
    EXPECT_EQ(made->boards[0].key, "tcp://x:1");
    EXPECT_EQ(made->boards[1].key, "/dev/ttyX9");
}

TEST_F(PlanFile, ChangedSection_HasAnotherText) {
    const auto first = plan("lease = 30\n[board a]\ntcp = x:1\n[board b]\ntcp = x:2\nlease = 9\n");
    const auto second = plan("lease = 31\n# moved\n[board b]\ntcp = x:2\nlease = 9\n[board a]\ntcp = x:1\n");
    ASSERT_TRUE(first && second);
    EXPECT_NE(first->boards[0].text, second->boards[1].text);
    EXPECT_EQ(first->boards[1].text, second->boards[0].text);
}

TEST_F(PlanFile, SharedBetweenTwoBoards_IsRefusedWithBothLines) {
    const std::string board = folder.write("ttyX1", "");
    std::filesystem::create_symlink(board, folder.file("by-id"));
    for (const auto& [content, what] :
         {std::pair{std::string("[board a]\ntcp = x:1\n[board a]\ntcp = x:2\n"), "the name a"},
          {std::string("[board a]\ntcp = x:1\n[board b]\ntcp = x:1\n"), "the port x:1"},
          {"[board a]\nserial = " + board + "\n[board b]\nserial = " + folder.file("by-id") + "\n",
           "the port "},
          {std::string("serial = /dev/ttyX9\n[board a]\n[board b]\n"), "the port /dev/ttyX9"}}) {
        EXPECT_THAT(error(content), HasSubstr(what));
        EXPECT_THAT(error(content), testing::ContainsRegex("boards.conf:[34]: .* line [12], too")) << content;
    }
    EXPECT_THAT(
        error("[board a]\ntcp = x:1\nlisten = 6789\n[board b]\ntcp = x:2\nlisten = 6790,6789\n"),
        HasSubstr("boards.conf:4: the address 127.0.0.1:6789 for clients is that of the board of line 1"));
    EXPECT_TRUE(plan("[board a]\ntcp = x:1\nlisten = 0\n[board b]\ntcp = x:2\nlisten = 0\n"));
}

TEST_F(PlanFile, WrongLines_AreNamed) {
    for (const auto& [content, where, what] :
         {std::tuple{"[board a]\ntcp = x:1\nname = b\n", ":3: ", "[board b]"},
          {"[board a]\ntcp = x:1\nlog-level = debug\n", ":3: ", "above the sections"},
          {"[board a]\ntcp = x:1\nlaese = 5\n", ":3", "did you mean \"lease\"?"},
          {"[board a]\ntcp = x:1\nlease = 1\n", ":3", "lease"},
          {"\n[board a]\nlease = 9\n", ":2: ", "--serial PORT or --tcp HOST:PORT"},
          {"[board a]\ntcp = x:1\n\n[board b/c]\ntcp = x:2\n", ":4: ", "--name"},
          {"[board a]\ntcp = x:1\n[bord b]\ntcp = x:2\n", ":3: ", "there is no section [bord b]"},
          {"[lamp]\ntcp = x:1\n", ":1: ", "there is no section [lamp]"},
          {"[board a\ntcp = x:1\n", ":1: ", "] is missing"}}) {
        EXPECT_THAT(error(content), HasSubstr(std::string("boards.conf") + where)) << content;
        EXPECT_THAT(error(content), HasSubstr(what)) << content;
    }
    EXPECT_THAT(error("tcp = x:1\n"), HasSubstr("no section [board NAME]"));
    EXPECT_FALSE(plan_of_file(folder.file("none.conf"), {}));
}

TEST_F(PlanFile, CredentialsOfAnotherBoard_AreRefused) {
    const auto file = folder.write("b.credentials", "broker = x\nuser = b\npassword = p\nname = b\n");
    EXPECT_THAT(error("[board a]\ntcp = x:1\ncredentials = " + file + "\n"),
                HasSubstr(":1: the credentials are for board b"));
    const auto made = plan("[board b]\ntcp = x:1\ncredentials = " + file + "\n");
    ASSERT_TRUE(made) << made.error();
    EXPECT_EQ(made->boards[0].options.mqtt.user, "b");
}

TEST_F(PlanFile, PortOnTheCommandLineBesideSections_IsRefused) {
    const auto path = folder.write("boards.conf", "[board a]\ntcp = x:1\n");
    for (const char* option : {"--serial", "--tcp", "--name", "--listen"}) {
        const std::vector<const char*> arguments{"asip-agent", "--config", path.c_str(), option, "1"};
        testing::internal::CaptureStderr();
        const auto made = read_plan(static_cast<int>(arguments.size()), arguments.data());
        EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr(option));
        ASSERT_FALSE(made);
        EXPECT_EQ(made.error(), program::kExitUsage);
    }
    const std::vector<const char*> arguments{"asip-agent", "--config", path.c_str()};
    EXPECT_TRUE(read_plan(static_cast<int>(arguments.size()), arguments.data()));
}

TEST(Plan, CommandLine_OneBoardWithoutFile) {
    const std::vector<const char*> arguments{"asip-agent", "--tcp", "x:1", "--name", "a"};
    const auto made = read_plan(static_cast<int>(arguments.size()), arguments.data());
    ASSERT_TRUE(made);
    EXPECT_FALSE(made->several());
    ASSERT_EQ(made->boards.size(), 1u);
    EXPECT_FALSE(made->boards[0].options.models.all().empty());
}

}  // namespace
}  // namespace asip::agent
