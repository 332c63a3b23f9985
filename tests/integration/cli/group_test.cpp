// SPDX-License-Identifier: Apache-2.0
// Verbs that take patterns and -l, on simulated boards with their agents; and names for what they find.
#include <gmock/gmock.h>

#include "tests/integration/cli/simulated_boards.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

class GroupTest : public SimulatedBoards {
  protected:
    void SetUp() override {
        ASSERT_NO_FATAL_FAILURE(start({"desk", "lamp", "old"}));
        ASSERT_EQ(asipctl({"label", "desk", "room=lab", "pin.12=fan"}).status, 0);
        ASSERT_EQ(asipctl({"label", "lamp", "room=lab", "pin.13=fan"}).status, 0);
    }
};

TEST_F(GroupTest, Ping_AsksAllAtATimeAndSumsUpEach) {
    const auto pinged = asipctl({"ping", "*", "-n", "2", "-i", "10ms"});
    EXPECT_EQ(pinged.status, 0) << pinged.errors;
    for (const char* board : {"desk", "lamp", "old"})
        for (const char* number : {"1", "2"})
            EXPECT_THAT(pinged.output, HasSubstr(std::string(board) + ": seq=" + number + " time="));
    EXPECT_THAT(pinged.output, HasSubstr("BOARD  SENT  ANSWERED"));
    const auto quiet = asipctl({"ping", "*", "-q", "-n", "3", "-i", "0", "-l", "room=lab", "-o", "jsonl"});
    EXPECT_EQ(quiet.status, 0) << quiet.errors;
    EXPECT_THAT(quiet.output, MatchesRegex(R"(\{"answered":3,"board":"desk",.*
\{"answered":3,"board":"lamp",.*
)"));
    ASSERT_NO_FATAL_FAILURE(kill_agent("old"));
    const auto without = asipctl({"ping", "*", "-n", "1"});
    EXPECT_EQ(without.status, 1) << "a board that was chosen did not answer";
    EXPECT_THAT(without.errors, HasSubstr("left out: old is lost"));
    EXPECT_THAT(without.output, HasSubstr("desk: seq=1 time="));
    EXPECT_EQ(asipctl({"ping", "o*", "-n", "1"}).status, 4);
}

TEST_F(GroupTest, Flash_LoadsEachInTurn_OrNoneWhereOneCannotBe) {
    const auto socket = folder_.file("sim.sock");
    const auto loaded =
        asipctl({"flash", "*", image("asip_uno_services"), "-l", "room=lab", "--socket", socket});
    EXPECT_EQ(loaded.status, 0) << loaded.errors;
    EXPECT_EQ(loaded.output, "desk: AsipServices, was AsipServices\nlamp: AsipServices, was AsipHello\n");
    EXPECT_THAT(loaded.errors, HasSubstr("2 of 2 boards have the new firmware"));
    EXPECT_THAT(loaded.errors, Not(HasSubstr("old")));
    const auto records =
        json::parse(asipctl({"flash", "?a*", image("asip_uno"), "--socket", socket, "-o", "json"}).output);
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0]["board"], "lamp");
    EXPECT_EQ(records[0]["sketch"], "AsipHello");
    // What is wrong is found before any port is released.
    const auto missing = asipctl({"flash", "*", folder_.file("no.elf"), "--socket", socket});
    EXPECT_EQ(missing.status, 2);
    EXPECT_THAT(missing.errors, HasSubstr("desk: "));
    EXPECT_THAT(missing.errors, Not(HasSubstr("port released")));
    EXPECT_THAT(asipctl({"flash", "*", image("asip_uno"), "--simulated", "desk"}).errors,
                HasSubstr("--simulated goes with one board"));
    agents_["old"]->signal(SIGTERM);
    ASSERT_TRUE(wait_state("old", "offline"));
    const auto away = asipctl({"flash", "*", image("asip_uno_services"), "--socket", socket});
    EXPECT_EQ(away.status, 0) << away.errors;
    EXPECT_THAT(away.errors, HasSubstr("old is left out: it is offline"));
}

}  // namespace
}  // namespace asip::test
