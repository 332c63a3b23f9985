// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "sim_program.hpp"
#include "tty_client.hpp"

namespace asip::test {
namespace {

TEST(Port, Opened_CarriesBytesBothWays) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json")});
    auto client = StreamClient::terminal(sim.port());
    client.write("EaEbEc");
    EXPECT_TRUE(client.expect("abc"));
}

TEST(Port, ManyBytesAtOnce_AllComeBack) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json")});
    auto client = StreamClient::terminal(sim.port());
    std::string request;
    std::string answer;
    for (int i = 0; i < 3000; ++i) {
        answer.push_back(static_cast<char>('a' + i % 26));
        request += {'E', answer.back()};
    }
    client.write(request);
    EXPECT_TRUE(client.expect(answer));
}

TEST(Port, NothingOpenAtBoot_WhatWasSaidThenIsNotKept) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json")});
    sim.control({"reset"});  // says hello again, to no reader; the answer comes after it was done
    sim.control({"list"});
    auto client = StreamClient::terminal(sim.port());
    client.write("Ea");
    ASSERT_TRUE(client.expect("a"));
    EXPECT_EQ(client.received().find('!'), std::string::npos);
}

TEST(Port, AtAWrongRate_GarblesAndReportsThatAndTheRightRateWorks) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json")});
    auto client = StreamClient::terminal(sim.port(), 9600);
    client.write({"\0", 1});
    EXPECT_TRUE(sim.process().wait_for_output("garbled bytes=1 direction=to-board"));
    client.set_baud(57600);
    client.write({"\0\0\0\0", 4});  // whatever the sketch made of the garbage ends here
    EXPECT_TRUE(wait_until([&] {
        client.write("Ea");
        return client.expect("a", 100ms);
    }));
}

TEST(Port, BoardStepsUp_ClientThatFollowsIsUnderstood) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json")});
    auto client = StreamClient::terminal(sim.port());
    client.write("B\x03");
    ASSERT_TRUE(client.expect("b"));
    client.set_baud(500000);
    client.write("Ea");
    EXPECT_TRUE(client.expect("a"));
}

TEST(Port, ResetOnOpen_RestartsTheSketchForEachProgram) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", R"(, "reset_on_open": true)")});
    for (int i = 0; i < 2; ++i) {
        auto client = StreamClient::terminal(sim.port());
        EXPECT_TRUE(client.expect("!\x02\n")) << "the sketch's hello, after an external reset";
    }
}

TEST(Port, Link_LeadsToThePortAndGoesWithTheProgram) {
    const TempDir folder;
    const auto link = folder.file("board");
    SimProgram sim(folder, {board_file(folder, "uno.json"), "--link", link});
    EXPECT_EQ(std::filesystem::read_symlink(link), sim.port());
    auto client = StreamClient::terminal(link);
    client.write("Ea");
    EXPECT_TRUE(client.expect("a"));
    EXPECT_EQ(sim.terminate(), 0);
    EXPECT_FALSE(std::filesystem::is_symlink(link));
    EXPECT_FALSE(std::filesystem::exists(sim.socket()));
}

TEST(Port, LinkBeforeTheImage_LeavesTheImageABoard) {
    const TempDir folder;
    const auto link = folder.file("board");
    SimProgram sim(folder, {"--link", link, "--tcp", "0", MONITOR_IMAGE});
    EXPECT_EQ(std::filesystem::read_symlink(link), sim.port());
    auto client = StreamClient::tcp(sim.tcp_port());
    client.write("Ea");
    EXPECT_TRUE(client.expect("a"));
}

TEST(Port, Interrupted_LeavesNothingBehind) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json"), "--link", folder.file("board")});
    sim.process().signal(SIGINT);
    EXPECT_EQ(sim.process().wait_exit(), 0);
    EXPECT_FALSE(std::filesystem::is_symlink(folder.file("board")));
    EXPECT_FALSE(std::filesystem::exists(sim.socket()));
}

TEST(Port, NobodyReadsItsOutput_Ends) {
    const TempDir folder;
    // The reset makes it print; 4 means that it does not listen yet.
    const auto done = run({"sh", "-c",
                           ASIP_SIM " \"$0\" --socket \"$1\" | { head -n 1; exec <&-; while " ASIP_SIM
                                    " ctl --socket \"$1\" reset; [ $? -eq 4 ]; do sleep 0.05; done; }",
                           board_file(folder, "uno.json"), folder.file("control.sock")});
    EXPECT_EQ(done.status, 0);
    EXPECT_EQ(done.output.find("uno 0.000000 port path="), 0u);
    EXPECT_FALSE(std::filesystem::exists(folder.file("control.sock")));
}

TEST(Port, LinkLeftByACrash_IsReplaced) {
    const TempDir folder;
    const auto link = folder.file("board");
    std::filesystem::create_symlink("/dev/pts/no-such-port", link);
    SimProgram sim(folder, {board_file(folder, "uno.json"), "--link", link});
    EXPECT_EQ(std::filesystem::read_symlink(link), sim.port());
}

TEST(Port, Tcp_CarriesBytesAndTurnsASecondClientAway) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json"), "--tcp", "0"});
    {
        auto client = StreamClient::tcp(sim.tcp_port());
        client.write("Ea");
        EXPECT_TRUE(client.expect("a"));
        auto second = StreamClient::tcp(sim.tcp_port());
        EXPECT_TRUE(wait_until([&] { return second.closed(); }));
        client.write("Eb");
        EXPECT_TRUE(client.expect("b"));
    }
    EXPECT_TRUE(wait_until([&] {
        auto next = StreamClient::tcp(sim.tcp_port());
        next.write("Ec");
        return next.expect("c", 200ms);
    })) << "once the first has left, the next one gets in";
}

TEST(Port, EepromFile_KeepsABoardsNameOverARestart) {
    const TempDir folder;
    const auto file =
        folder.write("uno.json", R"({"image": ")" SERVICES_IMAGE R"(", "eeprom": "uno.eeprom"})");
    {
        SimProgram sim(folder, {file});
        auto client = StreamClient::terminal(sim.port());
        ASSERT_TRUE(wait_until([&] {
            client.write("\n#,I,porch-1\n");
            return client.expect("@#,I,porch-1\n", 500ms);
        }));
        EXPECT_EQ(sim.terminate(), 0);
    }
    SimProgram sim(folder, {file});
    auto client = StreamClient::terminal(sim.port());
    EXPECT_TRUE(wait_until([&] {
        client.write("\n#,I\n");
        return client.expect("@#,I,porch-1\n", 500ms);
    }));
}

TEST(Port, ImageWithoutABoardFile_RunsAsABareBoard) {
    const TempDir folder;
    SimProgram sim(folder, {MONITOR_IMAGE});
    auto client = StreamClient::terminal(sim.port());
    client.write("Ea");
    EXPECT_TRUE(client.expect("a"));
}

}  // namespace
}  // namespace asip::test
