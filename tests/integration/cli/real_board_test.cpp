// SPDX-License-Identifier: Apache-2.0
// The main job from end to end: firmware in a simulated Uno, asip-agent, asip-registry, asipctl.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class RealBoardTest : public BusTest, public ::testing::WithParamInterface<const char*> {
  protected:
    /// An Uno with LED, button, potentiometer, distance sensor and servo, named `desk`.
    std::string board_file() const {
        return folder_.write(
            "desk.json",
            std::string(R"({"name":"desk","board":"uno","image":")") + ASIP_IMAGES + "/" + GetParam() +
                R"(","link":")" + folder_.file("port") +
                R"(","parts":[{"kind":"button","pin":2,"name":"button"},{"kind":"led","pin":13},)"
                R"({"kind":"ultrasonic","name":"distance","trigger":7,"echo":7,"distance":42},)"
                R"({"kind":"servo","name":"servo","pin":9}]})");
    }

    void SetUp() override {
        ASSERT_TRUE(sim_.wait_for_output("desk .*port")) << sim_.errors();
        agent_ = std::make_unique<ChildProcess>(
            Words{ASIP_PROGRAMS "/asip-agent", "--serial", folder_.file("port"), "--name", "desk"},
            environment());
        ASSERT_TRUE(probe_.wait_for("asip/servicebus/desk/$state", "online")) << agent_->errors();
        ASSERT_TRUE(probe_.wait_for("asip/servicebus/desk/$description"));
    }

    /// How often the LED went off.
    std::size_t times_dark() {
        std::size_t times = 0;
        const auto& said = sim_.output();
        for (auto at = said.find("led13 off"); at != std::string::npos; at = said.find("led13 off", at + 1))
            ++times;
        return times;
    }

    TempDir folder_;
    ChildProcess sim_{{ASIP_PROGRAMS "/asip-sim", "--no-socket", board_file()}};
    std::unique_ptr<ChildProcess> agent_;
};

INSTANTIATE_TEST_SUITE_P(Firmware, RealBoardTest,
                         ::testing::Values("asip_uno_services.elf", "asip_uno_04_services.elf"),
                         [](const auto& test) {
                             return std::string(test.param).find("04") == std::string::npos ? "Ours"
                                                                                            : "Asip04";
                         });

TEST_P(RealBoardTest, ListShowSendAndSubscribe_WorkOnIt) {
    const bool ours = std::string(GetParam()).find("04") == std::string::npos;
    EXPECT_THAT(asipctl({"list", "--from-bus"}).output,
                HasSubstr(std::string("desk   online  ATmega328P  AsipServices") + (ours ? " 0.2" : "") +
                          "  io distance servo"));
    EXPECT_THAT(asipctl({"show", "desk", "--from-bus"}).output,
                HasSubstr("write    servo 0..255, angle 0..180 degrees"));
    const auto moved = asipctl({"send", "desk/servo", "write", "0", "90"});
    EXPECT_EQ(moved.output, "ok\n") << moved.errors;
    EXPECT_TRUE(sim_.wait_for_output("servo (89|90|91)"));
    const auto refused = asipctl({"send", "desk/servo", "write", "9", "90"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.errors, HasSubstr("INVALID_DEVICE_NUMBER (error 7)"));
    EXPECT_EQ(asipctl({"get", "desk/servo/0/angle"}).output, "90 degrees\n");
    EXPECT_EQ(asipctl({"get", "des*/servo", "-o", "json"}).status, 0);
    EXPECT_EQ(asipctl({"get", "nobody*"}).status, 4);
    const auto measured = asipctl({"get", "desk/distance/0"});
    EXPECT_THAT(measured.output, MatchesRegex("4[123] cm\n")) << measured.errors;
    EXPECT_EQ(asipctl({"send", "desk/distance", "report", "100"}).status, 0);
    EXPECT_THAT(
        asipctl({"subscribe", "desk/distance", "-n", "1", "-W", "10", "--format", "{data.distance.0}"})
            .output,
        MatchesRegex("4[123]\n"));
    const auto all = asipctl({"get", "desk"});
    EXPECT_EQ(all.status, 0) << all.errors;
    EXPECT_THAT(all.output, MatchesRegex("(.|\n)*desk/distance/0 +Distance[ 0]* +4[123] cm(.|\n)*"));
    EXPECT_THAT(all.output, HasSubstr("90 degrees")) << "what was set";
}

TEST_P(RealBoardTest, NoReading_SwitchesALampOff) {
    EXPECT_EQ(asipctl({"pin", "desk", "13", "low"}).status, 0);
    EXPECT_EQ(asipctl({"pin", "desk", "2", "pullup"}).status, 0);
    for (int i = 0; i < 8; ++i) {
        ASSERT_EQ(asipctl({"pin", "desk", "13", "high"}).status, 0);
        const auto dark = times_dark();
        const Words readings[] = {{"get", "desk"},
                                  {"get", "desk/io"},
                                  {"pin", "desk", "13"},
                                  {"pin", "desk", "2"},
                                  {"show", "desk"}};
        for (const auto& words : readings)
            EXPECT_EQ(asipctl(words).status, 0) << words[0] << " " << asipctl(words).errors;
        EXPECT_EQ(asipctl({"get", "desk/io/13"}).output, "on\n");
        EXPECT_EQ(times_dark(), dark) << sim_.output();
        ASSERT_EQ(asipctl({"pin", "desk", "13", "low"}).status, 0);
        EXPECT_EQ(asipctl({"get", "desk/io/13"}).output, "off\n") << "what was answered before shows";
    }
}

TEST_P(RealBoardTest, PinsInWords_AreSetAndRead) {
    EXPECT_EQ(asipctl({"pin", "desk", "13", "high"}).output, "13 output high\n");
    EXPECT_TRUE(sim_.wait_for_output("led13 on"));
    EXPECT_EQ(asipctl({"pin", "desk", "13"}).output, "13 output high\n");
    EXPECT_EQ(asipctl({"pin", "desk", "13", "toggle"}).output, "13 output low\n");
    EXPECT_TRUE(sim_.wait_for_output("led13 off"));
    EXPECT_EQ(asipctl({"pin", "desk", "13", "toggle"}).output, "13 output high\n");
    EXPECT_EQ(asipctl({"pin", "desk", "2", "pullup"}).status, 0);
    EXPECT_EQ(asipctl({"pin", "desk", "2", "toggle"}).status, 4) << "what an input would become is not known";
    EXPECT_EQ(asipctl({"pin", "desk", "2"}).output, "2 input-pullup high\n");
    sim_.write_input("press desk/button\n");
    EXPECT_TRUE(
        wait_until([this] { return asipctl({"pin", "desk", "D2"}).output == "2 input-pullup low\n"; }));
    EXPECT_THAT(asipctl({"pin", "desk", "A0"}).output, MatchesRegex("14 analog [0-9]+\n"));
    const auto taken = asipctl({"pin", "desk", "9", "high"});
    EXPECT_EQ(taken.status, 1);
    EXPECT_THAT(taken.errors, HasSubstr("MODE_UNAVAILABLE"));
    EXPECT_THAT(taken.errors, HasSubstr("pin 9 belongs to the service desk/servo"));
    const auto pins = nlohmann::json::parse(asipctl({"pin", "desk", "-o", "json"}).output);
    ASSERT_EQ(pins.size(), 20U);
    EXPECT_EQ(pins[9]["owner"], "servo");
    EXPECT_EQ(pins[13]["mode"], "output");
}

TEST_P(RealBoardTest, WithARegistry_StatesAndForgettingAreItsJudgement) {
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment());
    ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "online"));
    const auto list = asipctl({"list"});
    EXPECT_THAT(list.output, HasSubstr("desk   online"));
    EXPECT_EQ(list.errors, "");
    EXPECT_EQ(asipctl({"doctor"}).status, 0) << asipctl({"doctor"}).output;
    EXPECT_EQ(asipctl({"forget", "desk"}).status, 1) << "it is alive";
    agent_.reset();  // killed: its will speaks
    EXPECT_EQ(asipctl({"wait", "desk", "--for", "lost", "--timeout", "20s"}).status, 0);
    const auto forget = asipctl({"forget", "desk"});
    EXPECT_EQ(forget.status, 0) << forget.errors;
    EXPECT_EQ(asipctl({"list", "-o", "name"}).output, "");
}

}  // namespace
}  // namespace asip::test
