// SPDX-License-Identifier: Apache-2.0
// Pixels, displays and I2C sensors driven over the bus: broker, agent, simulated board and parts are the real
// ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A simulated Uno with an agent, on a broker of its own.
class BoardOnTheBus {
  public:
    BoardOnTheBus(const std::string& image, const std::string& parts)
        : port_(folder_.file("uno")),
          sim_(start(image, parts)),
          probe(broker_.port()),
          agent_(broker_, port_) {
        if (!wait_state(probe, "online")) throw std::runtime_error(agent_.process().errors());
    }

    json ask(const std::string& service, const json& command) {
        const auto reply = probe.request("asip/uno1/" + service + "/in", command.dump());
        return reply ? json::parse(*reply) : json();
    }
    std::string status(const std::string& service, const json& command) {
        const auto reply = ask(service, command);
        return reply.value("status", "none") + reply.value("error", "");
    }
    /// Whether the simulator reported that the part shows this, now or before.
    bool shows(const std::string& part, const std::string& what) {
        return sim_->wait_for_output(" " + part + " " + what).has_value();
    }
    void tell(const std::string& command) { sim_->write_input(command + "\n"); }

  private:
    std::unique_ptr<ChildProcess> start(const std::string& image, const std::string& parts) {
        const auto file =
            folder_.write("uno.json", R"({"name":"uno","image":")" ASIP_IMAGES "/" + image +
                                          R"(.elf","link":")" + port_ + R"(","parts":)" + parts + "}");
        auto process = std::make_unique<ChildProcess>(
            std::vector<std::string>{ASIP_PROGRAMS "/asip-sim", file, "--no-socket"});
        if (!process->wait_for_output(" port ")) throw std::runtime_error("asip-sim: " + process->errors());
        return process;
    }

    TempDir folder_;
    std::string port_;
    std::unique_ptr<ChildProcess> sim_;
    MosquittoBroker broker_;

  public:
    BusProbe probe;

  private:
    Agent agent_;
};

constexpr const char* kImuParts =
    R"([{"kind":"mpu6050","name":"motion","ax":12,"ay":-340,"gx":1,"gy":-2,"gz":3},
    {"kind":"hmc5883l","name":"compass","x":100,"y":-20,"z":30},
    {"kind":"bmp085","name":"barometer","pressure":699.64,"temperature":15}])";

TEST(PixelsOnTheBus, WholeStripInOneCommand_IsShown) {
    BoardOnTheBus board("asip_uno_pixels", R"([{"kind":"pixels","name":"strip","pin":6}])");
    const std::vector<std::string> white(18, "#ffffff");
    EXPECT_EQ(board.status("pixels", {{"fill", {0, white}}}), "ok");
    EXPECT_TRUE(board.shows("strip", "(ffffff ?){18}"));
    EXPECT_EQ(board.status("pixels", {{"set", {{{"pixel", 17}, {"color", "#ff8000"}}}}}), "ok");
    EXPECT_TRUE(board.shows("strip", "(ffffff ){17}ff8000"));
    EXPECT_EQ(board.status("pixels", {{"brightness", 0}}), "ok");
    EXPECT_TRUE(board.shows("strip", "(000000 ?){18}"));
    EXPECT_EQ(board.ask("pixels", {{"count", nullptr}})["answer"], json({{"count", 18}}));
    EXPECT_EQ(board.ask("pixels", {{"fill", {17, {1, 2}}}})["code"], 7);
    const auto description = board.probe.wait_for("asip/servicebus/uno1/$description");
    ASSERT_TRUE(description);
    EXPECT_EQ(json::parse(description->payload)["firmware"]["extensions"]["L"], 172);
}

TEST(PixelsOnTheBus, CommandLongerThanTheBoardNames_IsRefusedWithTheReason) {
    BoardOnTheBus board("asip_uno_pixels", R"([{"kind":"pixels","name":"strip","pin":6}])");
    const auto reply = board.ask("pixels", {{"fill", {0, std::vector<std::string>(19, "#ffffff")}}});
    EXPECT_EQ(reply["status"], "refused");
    EXPECT_EQ(reply["reason"], "invalid");
    EXPECT_THAT(reply["error"].dump(), HasSubstr("longer than the board takes; send it in parts"));
    EXPECT_EQ(board.status("pixels", {{"fill", {0, {1}}}}), "ok");
}

TEST(PixelsOnTheBus, LongCommandForABoardOf62Characters_IsRefusedAndTheNextWorks) {
    BoardOnTheBus board("asip_uno", "[]");
    const auto reply = board.probe.request("asip/uno1/in", "I,d," + std::string(59, '1'));
    ASSERT_TRUE(reply);
    EXPECT_THAT(*reply, HasSubstr("longer than the board takes"));
    EXPECT_EQ(board.status("io", {{"mode", {13, "output"}}}), "ok");
}

TEST(NeoPixelsOnTheBus, PixelsOfAStrip_AreShownWhenAskedFor) {
    BoardOnTheBus board("asip_uno_neopixels", R"([{"kind":"pixels","name":"strip","pin":6,"count":2}])");
    EXPECT_EQ(board.status("neopixels", {{"color", {1, 1, 255, 128, 0}}}), "ok");
    EXPECT_EQ(board.status("neopixels", {{"show", 1}}), "ok");
    EXPECT_TRUE(board.shows("strip", "000000 ff8000"));
    EXPECT_EQ(board.ask("neopixels", {{"show", 2}})["code"], 7);
}

TEST(LcdOnTheBus, LinesAndBars_AreShown) {
    BoardOnTheBus board("asip_uno_lcd", R"([{"kind":"sh1106","name":"display"}])");
    EXPECT_EQ(board.status("lcd", {{"write", {0, "Hello, world"}}}), "ok");
    EXPECT_TRUE(board.shows("display", "0:Hello, world$"));
    EXPECT_EQ(board.status("lcd", {{"bars", {{{"line", 4}, {"percent", 50}}}}}), "ok");
    EXPECT_TRUE(board.shows("display", "0:Hello, world 4:\\[50 %\\]"));
    EXPECT_EQ(board.status("lcd", {{"clear", nullptr}}), "ok");
    EXPECT_TRUE(board.shows("display", "blank"));
}

TEST(SensorsOnTheBus, MeasuredValues_AreTheAnswer) {
    BoardOnTheBus board("asip_uno_imu", kImuParts);
    EXPECT_EQ(board.ask("acceleration", {{"measure", nullptr}})["answer"],
              json::parse(R"({"acceleration":{"x":12,"y":-340,"z":16384}})"));
    EXPECT_EQ(board.ask("gyroscope", {{"measure", nullptr}})["answer"],
              json::parse(R"({"gyroscope":{"x":1,"y":-2,"z":3}})"));
    EXPECT_EQ(board.ask("heading", {{"measure", nullptr}})["answer"],
              json::parse(R"({"heading":{"x":100,"y":-20,"z":30,"heading":348}})"));
    const auto pressure = board.ask("pressure", {{"measure", nullptr}})["answer"]["pressure"];
    EXPECT_EQ(pressure["pressure"], 699.64);
    EXPECT_EQ(pressure["temperature"], 15.0);
    EXPECT_NEAR(pressure["altitude"].get<double>(), 3016.6, 1);
}

TEST(SensorsOnTheBus, Reports_ComeAsEvents) {
    BoardOnTheBus board("asip_uno_imu", kImuParts);
    EXPECT_EQ(board.status("heading", {{"report", 50}}), "ok");
    EXPECT_TRUE(board.probe.wait_for("asip/uno1/heading/out",
                                     R"({"heading":{"heading":348,"x":100,"y":-20,"z":30}})"));
    board.tell("set compass x=0,y=100");
    EXPECT_TRUE(
        board.probe.wait_for("asip/uno1/heading/out", R"({"heading":{"heading":90,"x":0,"y":100,"z":30}})"));
}

TEST(SensorsOnTheBus, ChipThatIsDetached_IsTheBoardsErrorUntilItIsBack) {
    BoardOnTheBus board("asip_uno_imu", kImuParts);
    EXPECT_EQ(board.status("acceleration", {{"measure", nullptr}}), "ok");
    board.tell("detach motion");
    EXPECT_TRUE(board.shows("motion", "detached"));
    for (int i = 0; i < 3; ++i) {
        const auto reply = board.ask("acceleration", {{"measure", nullptr}});
        EXPECT_EQ(reply["status"], "error") << reply;
        EXPECT_EQ(reply.value("code", 0), 8);
    }
    EXPECT_EQ(board.status("heading", {{"measure", nullptr}}), "ok");
    board.tell("attach motion");
    EXPECT_TRUE(wait_until([&] { return board.status("acceleration", {{"measure", nullptr}}) == "ok"; }));
}

}  // namespace
}  // namespace asip::test
