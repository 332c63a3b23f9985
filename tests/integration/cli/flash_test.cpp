// SPDX-License-Identifier: Apache-2.0
// The port in other hands, end to end: a simulated Uno, its agent, asipctl release and flash; and each part
// killed.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;

class FlashTest : public BusTest {
  protected:
    std::string image(const std::string& name) const { return std::string(ASIP_IMAGES "/") + name + ".elf"; }

    void SetUp() override {
        const auto file =
            folder_.write("desk.json", R"({"name":"desk","board":"uno","image":")" + image("asip_uno") +
                                           R"(","link":")" + port_ + R"(","parts":[]})");
        sim_ = std::make_unique<ChildProcess>(Words{ASIP_PROGRAMS "/asip-sim", "--socket", socket_, file});
        ASSERT_TRUE(sim_->wait_for_output("desk .*port")) << sim_->errors();
        start_agent();
        ASSERT_TRUE(wait_state("online")) << agent_->errors();
    }

    void start_agent() {
        agent_ = std::make_unique<ChildProcess>(
            Words{ASIP_PROGRAMS "/asip-agent", "--serial", port_, "--name", "desk"}, environment());
    }

    bool wait_state(const std::string& state) {
        return wait_until([&] { return probe_.last("asip/servicebus/desk/$state") == state; });
    }

    std::string sketch() const {
        return asipctl({"show", "desk", "--from-bus", "--format", "{sketch}"}).output;
    }

    Words flash(const std::string& name) const { return {"flash", "desk", image(name), "--socket", socket_}; }

    bool is_free() const { return run({"sh", "-c", "exec 3<>" + port_ + "; flock -n 3"}).status == 0; }

    TempDir folder_;
    std::string port_ = folder_.file("port");
    std::string socket_ = folder_.file("sim.sock");
    std::unique_ptr<ChildProcess> sim_;
    std::unique_ptr<ChildProcess> agent_;
};

TEST_F(FlashTest, NewImage_AnswersUnderTheSameNameAndBothSketchesAreTold) {
    const auto flashed = asipctl(flash("asip_uno_services"));
    EXPECT_EQ(flashed.status, 0) << flashed.errors;
    EXPECT_EQ(flashed.output, "desk: AsipServices, was AsipHello\n");
    EXPECT_TRUE(probe_.wait_for("asip/servicebus/desk/$state", "updating"));
    EXPECT_TRUE(wait_state("online"));
    EXPECT_TRUE(wait_until([this] { return sketch() == "AsipServices\n"; }));
    EXPECT_THAT(asipctl({"list", "services", "--from-bus", "-o", "name"}).output, HasSubstr("desk/servo"));
    auto words = flash("asip_uno");
    words.insert(words.end(), {"-o", "json"});
    const auto back = nlohmann::json::parse(asipctl(words).output);
    EXPECT_EQ(back["sketch"], "AsipHello");
    EXPECT_EQ(back["was"], "AsipServices");
    EXPECT_EQ(back["same"], true);
}

TEST_F(FlashTest, ImageThatDoesNotFit_ChangesNothing) {
    const auto broken = folder_.write("broken.elf",
                                      "\x7f"
                                      "ELF nonsense");
    const auto flashed = asipctl({"flash", "desk", broken, "--socket", socket_});
    EXPECT_EQ(flashed.status, 1);
    EXPECT_THAT(flashed.errors, HasSubstr("failed with status"));
    EXPECT_EQ(flashed.output, "") << "no line of success";
    EXPECT_TRUE(wait_state("online"));
    const auto other = asipctl(flash("asip_mega"));
    EXPECT_EQ(other.status, 1);
    EXPECT_THAT(other.errors, HasSubstr("an image for another chip"));
    EXPECT_THAT(other.errors, HasSubstr("desk: answers with AsipHello"));
    EXPECT_EQ(other.output, "");
    EXPECT_TRUE(wait_state("online"));
    EXPECT_EQ(sketch(), "AsipHello\n");
    EXPECT_EQ(asipctl({"flash", "desk", folder_.file("nothing")}).status, 2);
    EXPECT_EQ(asipctl({"flash", "nobody", broken}).status, 4);
}

TEST_F(FlashTest, RealAvrdudeWithoutABootLoader_FailsAndTheBoardIsBack) {
    if (run({"sh", "-c", "command -v avrdude"}).status != 0) GTEST_SKIP() << "avrdude is not installed";
    ASSERT_EQ(asipctl({"release", "desk", "--for", "1m"}).status, 0);
    const auto avrdude = run({"avrdude", "-q", "-D", "-p", "m328p", "-c", "arduino", "-P", port_, "-b",
                              "115200", "-U", "flash:w:" + image("asip_uno") + ":e"},
                             {}, 60s);
    EXPECT_NE(avrdude.status, 0) << avrdude.errors;
    const auto back = asipctl({"release", "desk", "--back"});
    EXPECT_EQ(back.output, "AsipHello\n") << back.errors;
    EXPECT_TRUE(wait_state("online"));
}

TEST_F(FlashTest, Released_PortIsFreeAndCommandsAreRefused) {
    EXPECT_FALSE(is_free());
    const auto released = asipctl({"release", "desk", "--for", "1m", "-o", "json"});
    ASSERT_EQ(released.status, 0) << released.errors;
    const auto record = nlohmann::json::parse(released.output);
    EXPECT_EQ(record["path"], port_);
    EXPECT_TRUE(is_free());
    EXPECT_TRUE(wait_state("updating"));
    const auto second = asipctl({"release", "desk"});
    EXPECT_EQ(second.status, 1);
    EXPECT_THAT(second.errors, HasSubstr("refused (released)"));
    const auto sent = asipctl({"send", "desk/io", "write", "13", "1"});
    EXPECT_EQ(sent.status, 1);
    EXPECT_THAT(sent.errors, HasSubstr("board-not-there"));
    // Announced within a second.
    const auto until = "until " + record["until"].get<std::string>();
    EXPECT_TRUE(
        wait_until([&] { return asipctl({"show", "desk"}).output.find(until) != std::string::npos; }));
    const auto back = asipctl({"release", "desk", "--back"});
    EXPECT_EQ(back.output, "AsipHello\n") << back.errors;
    EXPECT_FALSE(is_free());
    EXPECT_EQ(asipctl({"release", "desk", "--back"}).status, 1);
}

TEST_F(FlashTest, BoardWithoutASketch_IsLostAndCanBeFlashedAgain) {
    const auto empty = folder_.write("empty.hex", ":02000000FFCF30\n:00000001FF\n");  // for ever: rjmp .
    const auto flashed = asipctl({"flash", "desk", empty, "--socket", socket_});
    EXPECT_EQ(flashed.status, 4) << flashed.errors;
    EXPECT_TRUE(wait_state("lost"));
    const auto again = asipctl(flash("asip_uno"));
    EXPECT_EQ(again.status, 0) << again.errors;
    EXPECT_TRUE(wait_state("online"));
}

TEST_F(FlashTest, AsipctlKilledWhileTheProgrammerRuns_ThePortComesBackWhenBothAreGone) {
    // Not known as a simulated port: the programmer is one that takes its time.
    const auto slow = folder_.write("slow", "#!/bin/sh\nexec sleep 4\n");
    std::filesystem::permissions(slow, std::filesystem::perms::owner_all);
    ASSERT_EQ(asipctl({"release", "desk", "--for", "2s"}).status, 0);
    // What flash does: the lock, inherited by the programmer; then killed.
    ChildProcess flash(
        {"sh", "-c", "exec 3<>" + port_ + "; flock -n 3 || exit 9; " + slow + " & kill -9 $$"});
    EXPECT_EQ(flash.wait_exit(), 137);
    EXPECT_TRUE(wait_state("updating"));
    EXPECT_FALSE(is_free()) << "the programmer has it, and no agent disturbs it";
    EXPECT_TRUE(wait_state("online"));
    EXPECT_EQ(sketch(), "AsipHello\n");
}

TEST_F(FlashTest, ProgrammerThatHangs_IsStoppedAndThePortComesBack) {
    // One that ends when it is asked to, and one that does not.
    for (const std::string trap : {"", "trap '' TERM; "}) {
        const auto hanging = folder_.write("hanging", "#!/bin/sh\n" + trap + "exec sleep 600\n");
        std::filesystem::permissions(hanging, std::filesystem::perms::owner_all);
        const auto flashed =
            asipctl({"flash", "desk", image("asip_uno"), "--avrdude", hanging, "--limit", "1s"});
        EXPECT_EQ(flashed.status, 1) << trap;
        EXPECT_THAT(flashed.errors, HasSubstr("did not end within 1s and was stopped")) << trap;
        EXPECT_THAT(flashed.errors, HasSubstr("--limit")) << trap;
        EXPECT_TRUE(wait_state("online")) << trap;
        EXPECT_FALSE(is_free()) << "the agent has it";
    }
    EXPECT_EQ(asipctl({"flash", "desk", image("asip_uno"), "--limit", "soon"}).status, 2);
    EXPECT_EQ(asipctl(flash("asip_uno_services")).status, 0) << "nothing is left locked";
}

}  // namespace
}  // namespace asip::test
