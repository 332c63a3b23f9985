// SPDX-License-Identifier: Apache-2.0
// What changes on the bus: waiting for it, following it, and what a registry has kept of it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class ChangesTest : public BusTest {
  protected:
    std::unique_ptr<ChildProcess> registry(const std::vector<std::string>& options = {}) {
        Words words{ASIP_PROGRAMS "/asip-registry", "--id", "r1"};
        words.insert(words.end(), options.begin(), options.end());
        auto child = std::make_unique<ChildProcess>(words, environment());
        EXPECT_TRUE(child->wait_for_errors("catalogue is complete")) << child->errors();
        return child;
    }

    TempDir folder_;
};

TEST_F(ChangesTest, WaitForAStateThatIs_EndsAtOnce) {
    announce("uno1");
    const auto wait = asipctl({"wait", "uno1"});
    EXPECT_EQ(wait.status, 0) << wait.errors;
    EXPECT_THAT(wait.output, IsEmpty());
    EXPECT_EQ(nlohmann::json::parse(asipctl({"wait", "uno1", "-o", "json"}).output)["state"], "online");
}

TEST_F(ChangesTest, WaitForAStateThatComes_EndsWhenItDoes) {
    announce("uno1");
    ChildProcess wait(program({"wait", "uno1", "--for", "lost", "--timeout", "1m"}), environment());
    ASSERT_TRUE(wait_until([&] {
        announce("uno1", "lost");
        return !wait.running();
    }));
    EXPECT_EQ(wait.wait_exit(), 0) << wait.errors();
}

TEST_F(ChangesTest, WaitForWhatDoesNotCome_EndsWith4AndTheState) {
    announce("uno1");
    const auto why = [this](const std::string& board, const std::string& time) {
        const auto wait = asipctl({"wait", board, "--for", "lost", "--timeout", time});
        EXPECT_EQ(wait.status, 4);
        EXPECT_THAT(wait.errors, Not(HasSubstr("the broker was")));
        return wait.errors;
    };
    EXPECT_THAT(why("uno1", "200ms"), HasSubstr("the board is online"));
    EXPECT_THAT(why("uno1", "0"), HasSubstr("the board is online"));
    EXPECT_THAT(why("nobody", "200ms"), HasSubstr("not announced"));
    probe_.publish("asip/servicebus/uno1/$state", "", true);  // what a broker is late with is not there
    EXPECT_THAT(why("uno1", "200ms"), HasSubstr("only an old description is retained"));
}

TEST_F(ChangesTest, WaitWhileTheBrokerIsGone_ClaimsNoState) {
    announce("uno1");
    ChildProcess wait(program({"wait", "uno1", "--for", "lost", "--timeout", "4s"}), environment());
    ASSERT_TRUE(probe_.wait_for("asip/servicebus/$probe"));
    broker_.kill();
    EXPECT_EQ(wait.wait_exit(), 3);
    EXPECT_THAT(wait.errors(), HasSubstr("closed the connection, and was not back in time"));
    EXPECT_THAT(wait.errors(), Not(HasSubstr("the board is")));
    broker_.start();
}

/// A registry that does not answer is said to be online: the search takes its time.
TEST_F(ChangesTest, CtrlCWhileTheRegistryIsLookedFor_EndsAtOnceAndSaysNothing) {
    probe_.publish("asip/registry/silent/$state", "online", true);
    ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    for (const Words& words : {Words{"events"}, Words{"events", "--since", "1h"}}) {
        probe_.clear();
        ChildProcess command(program(words), environment());
        ASSERT_TRUE(probe_.wait_for("asip/registry/query")) << words.front();
        command.signal(SIGINT);
        EXPECT_EQ(command.wait_exit(time_limit(2s)), 0) << words.front();
        EXPECT_EQ(command.errors(), "") << words.front();
    }
}

TEST_F(ChangesTest, RegistryWithAHistory_IsFollowedAndAsked) {
    const auto child = registry({"--history", folder_.file("history.db")});
    ChildProcess events(program({"events", "uno*", "-n", "1", "-o", "jsonl"}), environment());
    ASSERT_TRUE(wait_until([&] {
        announce("uno1");
        announce("uno1", "offline");
        return !events.running();
    }));
    EXPECT_EQ(events.wait_exit(), 0) << events.errors();
    EXPECT_EQ(nlohmann::json::parse(events.output())["board"], "uno1");
    const auto history = asipctl({"events", "uno1", "--last", "1000", "-o", "json"});
    ASSERT_EQ(history.status, 0) << history.errors;
    const auto changes = nlohmann::json::parse(history.output);
    ASSERT_FALSE(changes.empty());
    EXPECT_EQ(changes[0]["what"], "added") << "the oldest first";
    EXPECT_THAT(asipctl({"events", "--last", "1"}).output, HasSubstr("BOARD"));
    const auto unknown = asipctl({"events", "uno2", "--last", "20"});
    EXPECT_EQ(unknown.status, 4);
    EXPECT_THAT(unknown.errors, HasSubstr("no board 'uno2' on this bus (did you mean \"uno1\"?)"));
    EXPECT_EQ(asipctl({"events", "x*", "--last", "20"}).status, 4);
}

/// Answers `measure` as an agent does.
TEST_F(ChangesTest, Get_AsksTheBoardAndPrintsTheUnit) {
    announce("uno1");
    probe_.publish("asip/uno1/distance/out", R"({"distance":[1,1]})", true);
    ChildProcess get(program({"get", "uno1/distance/1"}), environment());
    const auto request = probe_.wait_for("asip/uno1/distance/in");
    ASSERT_TRUE(request);
    EXPECT_EQ(nlohmann::json::parse(request->payload).at("raw"), "M");
    answer(*request, R"({"status":"ok","proof":"answer","answer":{"distance":[42,118]}})");
    EXPECT_EQ(get.wait_exit(), 0) << get.errors();
    EXPECT_EQ(get.output(), "118 cm\n");
}

TEST_F(ChangesTest, GetOfAServiceThatCannotBeAsked_TakesTheNextReport) {
    announce("uno1");
    ChildProcess get(program({"get", "uno1/X", "-o", "json"}), environment());
    ASSERT_TRUE(wait_until([&] {
        probe_.publish("asip/uno1/X/out", R"({"tag":"k","body":"7"})");
        return !get.running();
    }));
    EXPECT_EQ(get.wait_exit(), 0) << get.errors();
    EXPECT_EQ(nlohmann::json::parse(get.output())["value"]["body"], "7");
    EXPECT_EQ(asipctl({"get", "uno1/X", "--timeout", "100ms"}).status, 4);
    EXPECT_THAT(asipctl({"get", "uno1/distance/distnace"}).errors, HasSubstr("did you mean \"distance\""));
}

}  // namespace
}  // namespace asip::test
