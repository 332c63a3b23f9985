// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sim_program.hpp"
#include "tty_client.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

const char* const kParts = R"(, "name": "desk", "parts": [
    {"kind": "led", "name": "lamp", "pin": 13}, {"kind": "button", "name": "button1", "pin": 2},
    {"kind": "potentiometer", "name": "pot", "pin": "A0"}])";

// Lets the sketch write 1 to pin 13: DDRB, then PORTB.
void light(StreamClient& client) {
    client.write({"W\x24\x00\x20W\x25\x00\x20", 8});
}

TEST(Control, Press_WorksTheButtonAndPrintsTheChange) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    const auto pressed = sim.control({"press", "button1"});
    EXPECT_EQ(pressed.status, 0) << pressed.errors;
    EXPECT_TRUE(sim.process().wait_for_output(R"(^desk [0-9]+\.[0-9]{6} button1 pressed$)"));
    auto client = StreamClient::terminal(sim.port());
    client.write({"W\x2b\x00\x04", 4});  // its pull-up on
    EXPECT_TRUE(wait_until([&] {
        client.write({"R\x29\x00", 3});  // what PIND reads: a button bounces at first
        return !client.received().empty() && (client.received().back() & 4) == 0;
    }));
}

TEST(Control, LedChanges_ArePrinted) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    auto client = StreamClient::terminal(sim.port());
    light(client);
    EXPECT_TRUE(sim.process().wait_for_output(R"(^desk [0-9.]+ lamp on$)"));
}

TEST(Control, Json_PrintsObjectsWithTheSimulatedTime) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts), "--json"});
    ASSERT_EQ(sim.control({"set", "pot", "0.25"}).status, 0);
    const auto line = sim.process().wait_for_output("potentiometer");
    ASSERT_TRUE(line);
    const auto change = nlohmann::json::parse(*line);
    EXPECT_EQ(change.at("board"), "desk");
    EXPECT_EQ(change.at("part"), "pot");
    EXPECT_EQ(change.at("value"), "0.25");
    EXPECT_GT(change.at("time").get<double>(), 0);
}

TEST(Control, StandardInput_TakesTheSameCommands) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    sim.process().write_input("press button1\nlist\nnonsense\nrelease button1\n");
    EXPECT_TRUE(sim.process().wait_for_output("button1 pressed"));
    EXPECT_TRUE(sim.process().wait_for_errors("desk/button1 button pressed"));
    EXPECT_TRUE(sim.process().wait_for_errors("there is no command \"nonsense\""));
    EXPECT_TRUE(sim.process().wait_for_output("button1 released"));
    sim.process().close_input();
    EXPECT_EQ(sim.control({"list"}).status, 0) << "the end of its input ends nothing";
    EXPECT_EQ(sim.control({"quit"}).status, 0);
    EXPECT_EQ(sim.process().wait_exit(), 0);
}

TEST(Control, EachLineEndThatTerminalsSend_EndsACommand) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    sim.process().write_input(std::string(3000, 'x') + "\r\npress button1\r");
    EXPECT_TRUE(sim.process().wait_for_errors("a command is too long"));
    EXPECT_TRUE(sim.process().wait_for_output("button1 pressed"));
    sim.process().write_input("release button1\r\n");
    EXPECT_TRUE(sim.process().wait_for_output("button1 released"));
    auto control = StreamClient::unix_socket(sim.socket());
    for (const char* end : {"\r", "\n", "\r\n", "\n\r"}) {
        const auto before = control.received().size();
        control.write(std::string("list") + end);
        EXPECT_TRUE(wait_until([&] { return control.received().find("ok\n", before) != std::string::npos; }))
            << end;
    }
    EXPECT_EQ(control.received().find("error"), std::string::npos);
}

TEST(Control, Load_TakesFilesWithBlanksInTheirNames) {
    const TempDir folder;
    const auto file = board_file(folder, "uno.json");
    const auto image = nlohmann::json::parse(std::ifstream(file)).at("image").get<std::string>();
    SimProgram sim(folder, {file, "--json"});
    std::filesystem::copy(image, folder.file("a  new sketch.elf"));
    const auto loaded = sim.control({"load", "uno", folder.file("a  new sketch.elf")});
    EXPECT_EQ(loaded.status, 0) << loaded.errors;
    EXPECT_TRUE(sim.process().wait_for_output("loaded"));
    EXPECT_THAT(sim.control({"load", "uno", folder.file("no such file")}).errors,
                HasSubstr("no such file: cannot"));
}

TEST(Control, BackgroundOfAShell_DoesNotStopIt) {
    const TempDir folder;
    const auto file = board_file(folder, "uno.json", kParts);
    const auto shell = run({"script", "--quiet", "--return", "--command",
                            "bash -c 'set -m; " ASIP_SIM " --no-socket " + file +
                                " & sleep 0.5; jobs; kill -TERM %1; kill -CONT %1; wait'",
                            "/dev/null"});
    EXPECT_THAT(shell.output, HasSubstr("Running"));
    EXPECT_THAT(shell.output, testing::Not(HasSubstr("Stopped")));
}

TEST(Control, List_ShowsBoardsPortsAndParts) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    const auto list = sim.control({"list"});
    EXPECT_EQ(list.output,
              "desk uno " + sim.port() +
                  "\ndesk/lamp led off\ndesk/button1 button released\ndesk/pot potentiometer 0.5\n");
}

TEST(Control, RefusedCommands_SayWhyAndChangeNothing) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    const auto refused = [&](std::vector<std::string> words) {
        const auto done = sim.control(std::move(words));
        EXPECT_EQ(done.status, 1);
        EXPECT_EQ(std::count(done.errors.begin(), done.errors.end(), '\n'), 1);
        return done.errors;
    };
    EXPECT_THAT(refused({"pres", "button1"}), HasSubstr("(did you mean \"press\"?)"));
    EXPECT_THAT(refused({"press", "buton1"}),
                HasSubstr("there is no part buton1 (did you mean \"button1\"?)"));
    EXPECT_THAT(refused({"press"}), HasSubstr("press what?"));
    EXPECT_THAT(refused({"press", "lamp"}), HasSubstr("it only shows"));
    EXPECT_THAT(refused({"set", "pot", "2"}), HasSubstr("from 0 to 1"));
    EXPECT_THAT(refused({"set", "pot", "1", "2"}), HasSubstr("too many words"));
    EXPECT_THAT(refused({"unplug", "desk2"}), HasSubstr("there is no board desk2 (did you mean \"desk\"?)"));
    EXPECT_THAT(refused({"replug"}), HasSubstr("plugged in already"));
    EXPECT_THAT(sim.control({"list"}).output, HasSubstr("desk/pot potentiometer 0.5"));
}

TEST(Control, SeveralBoards_PartIsNamedWithItsBoardWhereItHasTo) {
    const TempDir folder;
    const auto one =
        board_file(folder, "one.json", R"(, "parts": [{"kind": "button", "name": "b", "pin": 2}])");
    const auto two = board_file(
        folder, "two.json",
        R"(, "parts": [{"kind": "button", "name": "b", "pin": 2}, {"kind": "button", "name": "c", "pin": 3}])");
    SimProgram sim(folder, {one, two}, 2);
    EXPECT_THAT(sim.control({"press", "b"}).errors, HasSubstr("2 boards have a part b; name it one/b"));
    EXPECT_EQ(sim.control({"press", "two/b"}).status, 0);
    EXPECT_EQ(sim.control({"press", "c"}).status, 0);
    EXPECT_THAT(sim.control({"reset"}).errors, HasSubstr("which board? one, two"));
    EXPECT_EQ(sim.control({"list", "two"}).output.find("one"), std::string::npos);
    const auto list = sim.control({"list"}).output;
    EXPECT_THAT(list, HasSubstr("one/b button released"));
    EXPECT_THAT(list, HasSubstr("two/b button pressed"));
    EXPECT_THAT(list, HasSubstr("two/c button pressed"));
}

TEST(Control, Unplugged_PortAndLinkAreGoneUntilReplugged) {
    const TempDir folder;
    const auto link = folder.file("board");
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts), "--link", link});
    auto client = StreamClient::terminal(link);
    ASSERT_EQ(sim.control({"unplug"}).status, 0);
    EXPECT_TRUE(wait_until([&] { return client.closed(); }));
    EXPECT_FALSE(std::filesystem::is_symlink(link));
    EXPECT_THAT(sim.control({"list"}).output, HasSubstr("desk uno unplugged"));
    EXPECT_THAT(sim.control({"reset"}).errors, HasSubstr("desk is unplugged"));

    ASSERT_EQ(sim.control({"replug"}).status, 0);
    auto again = StreamClient::terminal(link);
    EXPECT_TRUE(wait_until([&] {
        again.write("Ea");
        return again.expect("a", 200ms);
    }));
}

TEST(Control, Reset_RestartsTheSketch) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    auto client = StreamClient::terminal(sim.port());
    ASSERT_EQ(sim.control({"reset"}).status, 0);
    EXPECT_TRUE(client.expect("!\x02\n"));
    EXPECT_TRUE(sim.process().wait_for_output("reset cause=external"));
}

TEST(Control, FirmwareStopsTheChip_IsReportedAndResetRevives) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    auto client = StreamClient::terminal(sim.port());
    client.write("Z");
    EXPECT_TRUE(sim.process().wait_for_output("desk [0-9.]+ stopped"));
    ASSERT_EQ(sim.control({"reset"}).status, 0);
    EXPECT_TRUE(client.expect("!\x02\n"));
}

TEST(Control, OverrunOfTheChip_IsReported) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    auto client = StreamClient::terminal(sim.port());
    client.write(
        "D\x14"
        "EaEbEcEd");
    EXPECT_TRUE(sim.process().wait_for_output("overrun bytes=5 direction=to-board"));
}

TEST(Control, Help_HasTheVerbsOfEveryKindOfPart) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json")});
    const auto help = sim.control({"help"}).output;
    EXPECT_THAT(help, HasSubstr("set ULTRASONIC CM"));
    EXPECT_THAT(help, HasSubstr("cut WIRE"));
    EXPECT_THAT(help, HasSubstr("unplug [BOARD]"));
}

TEST(Control, SocketFromTheEnvironment_IsUsed) {
    const TempDir folder;
    SimProgram sim(folder, {board_file(folder, "uno.json", kParts)});
    const auto list = run({"env", "ASIP_SOCKET=" + sim.socket(), ASIP_SIM, "ctl", "list"});
    EXPECT_EQ(list.status, 0) << list.errors;
    EXPECT_THAT(list.output, HasSubstr("desk/lamp led off"));
}

TEST(Control, NobodyListens_ExitStatusFour) {
    const TempDir folder;
    const auto done = run({ASIP_SIM, "ctl", "--socket", folder.file("none.sock"), "list"});
    EXPECT_EQ(done.status, 4);
    EXPECT_THAT(done.errors, HasSubstr("no asip-sim answers there"));
}

TEST(Control, SocketLeftByACrash_IsReplacedAndOneInUseIsNot) {
    const TempDir folder;
    const auto file = board_file(folder, "uno.json", kParts);
    {
        SimProgram crashed(folder, {file});
        crashed.process().signal(SIGKILL);
        ASSERT_EQ(crashed.process().wait_exit(), 128 + SIGKILL);
        ASSERT_TRUE(std::filesystem::exists(crashed.socket()));
    }
    SimProgram sim(folder, {file});
    EXPECT_EQ(sim.control({"list"}).status, 0);
    const auto second = run({ASIP_SIM, file, "--socket", sim.socket()});
    EXPECT_EQ(second.status, 2);
    EXPECT_THAT(second.errors, HasSubstr("another asip-sim listens there"));
    EXPECT_EQ(sim.control({"list"}).status, 0);
}

}  // namespace
}  // namespace asip::test
