// SPDX-License-Identifier: Apache-2.0
// The names that `asipctl flash --class` gives, against scripted agents.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"

namespace asip::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class NamesOfAClass : public BusTest {
  protected:
    /// A board that speaks ASIP, at a port of its own.
    void plug(const std::string& board, const std::string& port) {
        auto description = nlohmann::json::parse(cli::kUno1);
        description["board"] = board;
        description["link"]["path"] = "/dev/" + port;
        description["state"] = {{"is", "online"}};
        probe_.publish("asip/servicebus/" + board + "/$description", description.dump(), true);
    }

    /// The name that the board at this port is told to keep, by which it comes then.
    std::string take_name(const std::string& port) {
        const auto told = probe_.wait_for("asip/" + port + "/in");
        if (!told) return "none";
        const auto request = nlohmann::json::parse(told->payload, nullptr, false);
        const std::string line = request.is_object() ? request.value("raw", "") : told->payload;
        if (!line.starts_with("#,I,")) return line;
        answer(*told, R"({"status":"ok","proof":"fence"})");
        const auto name = line.substr(4);
        plug(name, port);
        return name;
    }
};

// The broker hands descriptions out in the order in which they came, or in the other one.
TEST_F(NamesOfAClass, NameThatABoardOfTheBusHas_IsGivenToNoOtherWhicheverIsHeardFirst) {
    plug("ttyACM0", "ttyACM0");
    plug("room-1", "ttyACM1");
    plug("ttyACM2", "ttyACM2");
    probe_.publish("asip/servicebus/room-3/$description", "of an agent to come", true);
    ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    ChildProcess teacher(program({"flash", "--class", "--names", "room-{}", "--at", "*", "--count", "3"}),
                         environment());
    EXPECT_EQ(take_name("ttyACM0"), "room-2");
    EXPECT_EQ(take_name("ttyACM2"), "room-4");
    EXPECT_EQ(teacher.wait_exit(), 0) << teacher.output() << teacher.errors();
    EXPECT_THAT(teacher.output(), ContainsRegex("room-1 +passed over"));
    EXPECT_THAT(teacher.output(), HasSubstr("0 loaded, 2 named, 1 passed over, 0 failed"));
}

}  // namespace
}  // namespace asip::test
