// SPDX-License-Identifier: Apache-2.0
// What boards report, in the forms that people and scripts ask for; lists by condition; models.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class ValuesTest : public BusTest {
  protected:
    /// Publishes `payloads` in turn until the program has ended.
    void report_until_ended(ChildProcess& child, const Words& payloads) {
        std::size_t next = 0;
        ASSERT_TRUE(wait_until([&] {
            probe_.publish("asip/uno1/distance/out", payloads[next++ % payloads.size()]);
            return !child.running();
        })) << child.errors();
        child.wait_exit();  // what it wrote last is read
    }

    TempDir folder_;
};

TEST_F(ValuesTest, Subscribe_ShowsUnitsAndOneField) {
    announce("uno1");
    ChildProcess whole(program({"subscribe", "uno1", "-n", "1"}), environment());
    report_until_ended(whole, {R"({"distance":[42,118]})"});
    EXPECT_EQ(whole.output(), "uno1/distance  distance 42 cm, 118 cm\n");
    ChildProcess field(program({"subscribe", "uno*", "--field", "1", "-n", "1", "-o", "jsonl"}),
                       environment());
    report_until_ended(field, {R"({"distance":[42,118]})"});
    const auto record = nlohmann::json::parse(field.output());
    EXPECT_EQ(record["value"], 118);
    EXPECT_EQ(record["unit"], "cm");
    EXPECT_EQ(record["field"], "distance/1");
    EXPECT_EQ(asipctl({"subscribe", "uno1", "--raw", "--field", "0"}).status, 2);
    EXPECT_EQ(asipctl({"subscribe", "uno1", "--max-hz", "0"}).status, 2);
}

TEST_F(ValuesTest, Header_StandsOnceAndOnlyOnATerminal) {
    announce("uno1");
    ChildProcess terminal(
        {"script", "-qefc", ASIP_PROGRAMS "/asipctl subscribe uno1/distance -n 2 --color never",
         folder_.file("typescript")},
        environment());
    report_until_ended(terminal, {R"({"distance":[42]})"});
    EXPECT_THAT(terminal.output(),
                StartsWith("SERVICE  VALUE\r\nuno1/distance  distance 42 cm\r\nuno1/dist"));
}

TEST_F(ValuesTest, EventsSince_BeginWithWhatWasKeptAndContinue) {
    announce("old");
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1", "--history", folder_.file("h.db")},
                          environment());
    ASSERT_TRUE(registry.wait_for_errors("catalogue is complete"));
    announce("old", "lost");
    ASSERT_TRUE(wait_until(
        [&] { return asipctl({"events", "old", "--last", "20"}).output.find("lost") != std::string::npos; }));
    ChildProcess events(program({"events", "--since", "1h", "--format", "{board} {what} {state}"}),
                        environment());
    ASSERT_TRUE(events.wait_for_output("^old added")) << events.errors();
    ASSERT_TRUE(events.wait_for_output("^old state lost"));
    announce("new");
    EXPECT_TRUE(events.wait_for_output("^new added"));
    EXPECT_EQ(asipctl({"events", "--since", "2100-01-01", "-W", "100ms"}).status, 4);
    EXPECT_EQ(asipctl({"events", "--since", "yesterday"}).status, 2);
}

TEST_F(ValuesTest, TwoRegistriesKeep_TheLongestIsShownAndNamed) {
    auto description = nlohmann::json::parse(cli::kUno1);
    description["board"] = "desk";
    description["names"]["services"]["distance"] = "front";
    probe_.publish("asip/servicebus/desk/$description", description.dump(), true, 1);
    probe_.publish("asip/servicebus/desk/$state", "online", true, 1);
    auto say = [&, seq = 0](int value) mutable {
        probe_.publish(
            "asip/desk/$values",
            nlohmann::json{{"version", 1},
                           {"board", "desk"},
                           {"session", description["session"]},
                           {"seq", ++seq},
                           {"values", {{"distance/0", {{"value", value}, {"how", "reported"}, {"age", 0}}}}}}
                .dump(),
            true, 1);
    };
    const auto registry = [&](const std::string& id) {
        return std::make_unique<ChildProcess>(
            Words{ASIP_PROGRAMS "/asip-registry", "--id", id, "--history", folder_.file(id + ".db")},
            environment());
    };
    const auto values = [&] { return asipctl({"values", "desk/distance/0", "-o", "csv"}); };
    say(41);
    // The one with the later name began earlier: the order of names does not decide.
    const auto old = registry("r9");
    ASSERT_TRUE(wait_until([&] { return values().output.find(",41.0,") != std::string::npos; }, 40s))
        << old->errors();
    say(42);
    const auto young = registry("r1");
    ASSERT_TRUE(young->wait_for_errors("catalogue is complete"));
    say(43);
    ASSERT_TRUE(wait_until(
        [&] {
            const auto both = values();
            return both.output.find(",41.0,") != std::string::npos &&
                   both.output.find(",43.0,") != std::string::npos &&
                   both.errors.find("of 2 registries, r9 kept it for the longest") != std::string::npos;
        },
        40s))
        << values().output << values().errors;
    EXPECT_EQ(asipctl({"values", "desk", "--format", "{property}"}).output, "distance/0\n");
}

TEST(Models, AreListedAndExplainedWithoutABroker) {
    const auto asipctl = [](std::vector<std::string> words) {
        words.insert(words.begin(), {ASIP_PROGRAMS "/asipctl", "--broker", "127.0.0.1:1"});
        return run(words);
    };
    const auto models = nlohmann::json::parse(asipctl({"model", "-o", "json"}).output);
    const auto distance =
        std::ranges::find_if(models, [](const auto& one) { return one["kind"] == "distance"; });
    ASSERT_NE(distance, models.end());
    EXPECT_EQ((*distance)["letter"], "D");
    EXPECT_THAT((*distance)["commands"].dump(), HasSubstr("measure"));
    EXPECT_THAT(asipctl({"model", "-o", "name"}).output, HasSubstr("servo\n"));
    const auto explained = asipctl({"model", "distance"});
    EXPECT_EQ(explained.status, 0);
    EXPECT_THAT(explained.output, HasSubstr("distance 0..400 cm"));
    EXPECT_THAT(explained.output, HasSubstr("@D,e,2,{42,118}"));
    EXPECT_EQ(asipctl({"model", "servo", "--format", "{id}"}).output, "S\n");
    const auto unknown = asipctl({"model", "srevo"});
    EXPECT_EQ(unknown.status, 1);
    EXPECT_THAT(unknown.errors, HasSubstr("did you mean \"servo\""));
}

}  // namespace
}  // namespace asip::test
