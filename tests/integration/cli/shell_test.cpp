// SPDX-License-Identifier: Apache-2.0
// asipctl shell on a real pseudo-terminal, and with its input from a pipe: real broker, real firmware, both
// our own and that of ASIP 0.4.
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/support/terminal.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using ShellWithoutBoard = BusTest;

TEST_F(ShellWithoutBoard, UnknownBoard_IsAnErrorWhateverTheInput) {
    announce("uno1");
    for (const std::string input : {"", "help\n", "get distance\n"}) {
        ChildProcess shell(program({"shell", "uno2"}), environment());
        shell.write_input(input);
        shell.close_input();
        EXPECT_EQ(shell.wait_exit(), 4) << input;
        EXPECT_THAT(shell.errors(), HasSubstr("did you mean \"uno1\"?"));
        EXPECT_EQ(shell.output(), "");
    }
    ChildProcess shell(program({"shell", "uno1"}), environment());
    shell.close_input();
    EXPECT_EQ(shell.wait_exit(), 0) << shell.errors();
}

TEST_F(ShellWithoutBoard, EachLineEnd_EndsOneLine) {
    announce("uno1");
    for (const std::string end : {"\n", "\r", "\r\n"}) {
        ChildProcess shell(program({"shell", "uno1"}), environment());
        shell.write_input("help" + end + "nonsense here" + end + "help" + end);
        shell.close_input();
        shell.wait_exit();
        EXPECT_THAT(shell.errors(), HasSubstr("line 2: ")) << end;
        const auto output = shell.output();
        EXPECT_EQ(output.size() % 2, 0u);
        EXPECT_EQ(output.substr(0, output.size() / 2), output.substr(output.size() / 2)) << "help twice";
        EXPECT_NE(output, "");
    }
}

class ShellTest : public BusTest, public ::testing::WithParamInterface<const char*> {
  protected:
    std::string board_file() const {
        return folder_.write(
            "desk.json", std::string(R"({"name":"desk","board":"uno","image":")") + ASIP_IMAGES + "/" +
                             GetParam() + R"(","link":")" + folder_.file("port") +
                             R"(","parts":[{"kind":"led","pin":13},)"
                             R"({"kind":"ultrasonic","name":"distance","trigger":7,"echo":7,"distance":42},)"
                             R"({"kind":"servo","name":"servo","pin":9}]})");
    }

    void SetUp() override {
        ASSERT_TRUE(sim_.wait_for_output("desk .*port")) << sim_.errors();
        start_agent();
    }
    void start_agent() {
        agent_ =
            std::make_unique<ChildProcess>(Words{ASIP_PROGRAMS "/asip-agent", "--serial",
                                                 folder_.file("port"), "--name", "desk", "--lease", "60"},
                                           environment());
        ASSERT_TRUE(probe_.wait_for("asip/servicebus/desk/$state", "online")) << agent_->errors();
        ASSERT_TRUE(probe_.wait_for("asip/servicebus/desk/$description"));
    }

    std::map<std::string, std::string> shell_environment() const {
        auto result = environment();
        result["XDG_STATE_HOME"] = folder_.file("state");
        result["HOME"] = folder_.path().string();
        return result;
    }
    std::unique_ptr<TerminalProcess> shell(Words more = {}) const {
        Words words{"shell", "desk"};
        words.insert(words.end(), more.begin(), more.end());
        auto result = std::make_unique<TerminalProcess>(program(words), shell_environment());
        EXPECT_TRUE(result->edits("desk>")) << result->screen().text();
        return result;
    }
    Finished script(const std::string& input) const {
        ChildProcess process(program({"shell", "desk"}), shell_environment());
        process.write_input(input);
        process.close_input();
        Finished result;
        result.status = process.wait_exit().value_or(-1);
        result.output = process.output();
        result.errors = process.errors();
        return result;
    }

    TempDir folder_;
    ChildProcess sim_{{ASIP_PROGRAMS "/asip-sim", "--no-socket", board_file()}};
    std::unique_ptr<ChildProcess> agent_;
};

INSTANTIATE_TEST_SUITE_P(Firmware, ShellTest,
                         ::testing::Values("asip_uno_services.elf", "asip_uno_04_services.elf"),
                         [](const auto& test) {
                             return std::string(test.param).find("04") == std::string::npos ? "Ours"
                                                                                            : "Asip04";
                         });

TEST_P(ShellTest, CommandsAreCompletedSentAndKept) {
    auto shell = this->shell({"--values", "off"});
    shell->type("ser");
    shell->type("\t");
    EXPECT_TRUE(shell->edits("desk> servo"));
    shell->type("wr\t0 90\n");
    EXPECT_TRUE(sim_.wait_for_output("servo (89|90|91)"));
    EXPECT_TRUE(shell->shows("^ok$")) << shell->screen().text();
    shell->type("get distance/0\n");
    EXPECT_TRUE(shell->shows("^42 cm$")) << shell->screen().text();
    shell->type("pin 13 high\n");
    EXPECT_TRUE(shell->shows("^13 output high$")) << shell->screen().text();
    shell->type("servo write 9 9\n");
    EXPECT_TRUE(shell->shows("INVALID_DEVICE_NUMBER")) << shell->screen().text();
    shell->type("nosuch x\n");
    EXPECT_TRUE(shell->shows("no service 'nosuch'"));
    shell->type("help\n");
    EXPECT_TRUE(shell->shows("Turn a servo to an angle"));
    EXPECT_TRUE(shell->edits("desk>"));
    shell->type("\x04");
    EXPECT_EQ(shell->wait_exit(), 0);
    // Another one knows what was typed.
    auto next = this->shell({"--values", "off"});
    next->type("\033[A\033[A\033[A");
    EXPECT_TRUE(next->edits("desk> servo write 9 9"));
    next->type(
        "\x03\x12"
        "wr");
    EXPECT_TRUE(next->shows("servo write 9 9$"));
    next->type("\x03");
    next->type("exit\n");
    EXPECT_EQ(next->wait_exit(), 0);
}

TEST_P(ShellTest, ValuesStandAboveTheLine_WhichStaysAsItIs) {
    auto shell = this->shell();
    shell->type("servo wri");
    EXPECT_TRUE(shell->edits("desk> servo wri"));
    ASSERT_EQ(asipctl({"send", "desk/distance", "report", "100"}).status, 0);
    EXPECT_TRUE(shell->shows("distance 42, none cm")) << shell->screen().text();
    EXPECT_TRUE(shell->edits("desk> servo wri")) << shell->screen().text();
    const auto screen = shell->screen();
    EXPECT_THAT(screen.line(screen.row() - 1), HasSubstr("distance 42, none cm"));
    EXPECT_EQ(screen.column(), 15U);
    shell->type("te 0 90\n");
    EXPECT_TRUE(sim_.wait_for_output("servo (89|90|91)")) << shell->screen().text();
    EXPECT_TRUE(shell->edits("desk>"));
    shell->type(
        "\x0c"
        "values servo\n");
    EXPECT_TRUE(shell->edits("desk>"));
    EXPECT_TRUE(wait_until([&] {
        const auto now = shell->screen();
        return now.row() > 0 && now.line(now.row() - 1) == "desk> values servo";
    })) << shell->screen().text();
    shell->type("values nosuch\n");
    EXPECT_TRUE(shell->shows("has no service 'nosuch'"));
    shell->type("exit\n");
    EXPECT_EQ(shell->wait_exit(), 0);
}

TEST_P(ShellTest, LinesLongerThanTheTerminal_AndBytesThatAreNoText_AreTakenOrRefused) {
    auto shell = this->shell();
    ASSERT_EQ(asipctl({"send", "desk/distance", "report", "100"}).status, 0);
    EXPECT_TRUE(shell->shows("distance 42, none cm"));
    const std::string tail(150, 'x');
    shell->type("servo write " + tail);
    EXPECT_TRUE(shell->edits(std::string(150 - 62 - 80, 'x'))) << shell->screen().text();
    ASSERT_EQ(asipctl({"send", "desk/distance", "report", "0"}).status, 0);
    ASSERT_EQ(asipctl({"pin", "desk", "13", "high"}).status, 0);
    EXPECT_TRUE(shell->shows("modes")) << shell->screen().text();
    const auto both_rows = [&] {
        const auto screen = shell->screen();
        return screen.row() >= 3 &&
               screen.line(screen.row() - 2) == "desk> servo write " + std::string(62, 'x') &&
               screen.line(screen.row() - 1) == std::string(80, 'x');
    };
    EXPECT_TRUE(wait_until(both_rows)) << shell->screen().text();
    shell->type("\x03");
    EXPECT_TRUE(shell->edits("desk>"));
    shell->resize(24, 40);
    shell->type("servo write 0 10");
    EXPECT_TRUE(shell->edits("desk> servo write 0 10")) << shell->screen().text();
    shell->type("\x03");
    EXPECT_TRUE(shell->edits("desk>"));
    shell->resize(24, 80);
    for (int i = 0; i < 10; ++i)
        shell->type(std::string(2000, 'y'));
    shell->type("\x03");
    EXPECT_TRUE(shell->edits("desk>"));
    shell->type(std::string("\xff\xfe\x00\x80\x1c", 5) + "servo write 0 90\n");
    EXPECT_TRUE(sim_.wait_for_output("servo (89|90|91)")) << shell->screen().text();
    EXPECT_TRUE(shell->shows("the line has control characters")) << shell->screen().text();
    EXPECT_TRUE(shell->edits("desk>")) << "before the command has ended Ctrl-D is not the shell's";
    shell->type("\x04");
    EXPECT_EQ(shell->wait_exit(), 0);
}

TEST_P(ShellTest, CtrlC_LeavesTheLine_AndEndsWhatRuns_NotTheShell) {
    auto shell = this->shell({"--values", "off"});
    shell->type("servo write 0 10\x03");
    EXPECT_TRUE(shell->edits("desk>"));
    shell->type("distance report 50\nsubscribe distance\n");
    EXPECT_TRUE(shell->shows("desk/distance  distance 42"));
    shell->type("\x03");
    EXPECT_TRUE(shell->edits("desk>")) << shell->screen().text();
    EXPECT_THAT(sim_.output(), Not(HasSubstr("servo 10")));
    for (int i = 0; i < 20; ++i)
        shell->type("\x03");
    EXPECT_TRUE(shell->edits("desk>"));
    // The end of the shell is the end of what it runs.
    shell->type(
        "\x0c"
        "subscribe distance --format 'again {text}'\n");
    EXPECT_TRUE(shell->shows("^again"));
    kill(shell->pid(), SIGTERM);
    EXPECT_EQ(shell->wait_exit(), 0);
    auto closed = this->shell({"--values", "off"});
    kill(closed->pid(), SIGHUP);
    EXPECT_EQ(closed->wait_exit(), 0);
}

TEST_P(ShellTest, TheBoardAndTheBroker_MayComeAndGo) {
    auto shell = this->shell({"--values", "off"});
    shell->type("servo wri");
    agent_->signal(SIGKILL);
    ASSERT_TRUE(agent_->wait_exit());
    EXPECT_TRUE(shell->shows("desk is lost"));
    EXPECT_TRUE(shell->edits("desk (lost)> servo wri")) << shell->screen().text();
    shell->type("te 0 90\n");
    EXPECT_TRUE(shell->shows("its agent died or lost the broker")) << shell->screen().text();
    start_agent();
    EXPECT_TRUE(shell->edits("desk>")) << shell->screen().text();
    broker_.stop();
    EXPECT_TRUE(shell->edits("desk (no broker)>")) << shell->screen().text();
    broker_.start();
    EXPECT_TRUE(shell->shows("connected again"));
    EXPECT_TRUE(shell->edits("desk>")) << shell->screen().text();
    shell->type("exit\n");
    EXPECT_EQ(shell->wait_exit(), 0);
}

TEST_P(ShellTest, LinesOfAPipe_AreRunInOrder_AndTheFirstFailureIsTheStatus) {
    const auto good =
        script("# a comment\n\nservo write 0 90\r\nget distance/0 --raw\nvalues off\nexit\nnosuch\n");
    EXPECT_EQ(good.output, "ok\n42\n") << good.errors;
    EXPECT_EQ(good.errors, "");
    EXPECT_EQ(good.status, 0);
    EXPECT_TRUE(sim_.wait_for_output("servo (89|90|91)"));
    const auto bad = script("servo turn\nservo write 9 9\nservo write 0 10");
    EXPECT_EQ(bad.output, "ok\n");
    EXPECT_EQ(bad.status, 2) << bad.errors;
    EXPECT_THAT(bad.errors, HasSubstr("line 1: ended with status 2"));
    EXPECT_THAT(bad.errors, HasSubstr("line 2: ended with status 1"));
    const auto strange =
        script(std::string("\0\xff\n", 3) + std::string(100'000, 'x') + "\n'open\nservo write 0 20\n");
    EXPECT_EQ(strange.output, "ok\n");
    EXPECT_EQ(strange.status, 2);
    EXPECT_THAT(strange.errors, HasSubstr("line 1: the line has control characters"));
    EXPECT_THAT(strange.errors, HasSubstr("line 2: a line of more than 8192 bytes"));
    EXPECT_THAT(strange.errors, HasSubstr("line 3: a quote is never closed"));
    EXPECT_EQ(script("").status, 0);
}

TEST_P(ShellTest, ABoardThatIsNot_IsNamedAtOnce) {
    TerminalProcess shell(program({"shell", "dsk"}), shell_environment());
    EXPECT_TRUE(shell.shows("no board 'dsk'.*desk")) << shell.screen().text();
    EXPECT_EQ(shell.wait_exit(), 4);
    EXPECT_EQ(asipctl({"shell", "desk/servo"}).status, 2);
}

}  // namespace
}  // namespace asip::test
