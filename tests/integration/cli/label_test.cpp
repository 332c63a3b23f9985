// SPDX-License-Identifier: Apache-2.0
// Labels end to end: simulated boards, their agents, a registry and asipctl; and the agent killed.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/simulated_boards.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

class LabelTest : public SimulatedBoards {
  protected:
    std::string labels(const std::string& board) const {
        return asipctl({"label", board, "--from-bus", "--format", "{labels}"}).output;
    }

    std::string names_of(Words words) const {
        words.insert(words.begin(), "list");
        words.insert(words.end(), {"-o", "name"});
        return asipctl(words).output;
    }
};

TEST_F(LabelTest, Labels_AreSetShownChosenByAndRemoved) {
    ASSERT_NO_FATAL_FAILURE(start({"desk", "old"}));
    const auto set = asipctl({"label", "desk", "room=lab", "owner=Ann, Zoë", "pin.13=status lamp"});
    EXPECT_EQ(set.status, 0) << set.errors;
    EXPECT_THAT(set.output, MatchesRegex("TARGET +KEY +VALUE\n"
                                         "desk +owner +Ann, Zoë\n"
                                         "desk +room +lab\n"
                                         "desk +pin.13 +status lamp\n"));
    EXPECT_EQ(asipctl({"label", "desk/servo", "name=left arm"}).output,
              "TARGET      KEY   VALUE\ndesk/servo  name  left arm\n");
    EXPECT_EQ(asipctl({"label", "old", "room=lab", "retired="}).status, 0) << "ASIP 0.4";
    EXPECT_EQ(names_of({"-l", "room=lab", "--from-bus"}), "desk\nold\n") << "at once";
    EXPECT_EQ(names_of({"-l", "room=lab,!retired", "--from-bus"}), "desk\n");
    EXPECT_EQ(names_of({"-l", "owner=\"Ann, Zoë\"", "--from-bus"}), "desk\n");
    EXPECT_EQ(names_of({"-l", "room=hall", "--from-bus"}), "");
    const auto shown = asipctl({"show", "desk"}).output;
    EXPECT_THAT(shown, HasSubstr("label      room=lab\n"));
    EXPECT_THAT(shown, HasSubstr("name       left arm\n"));
    EXPECT_THAT(shown, HasSubstr("status lamp"));
    EXPECT_THAT(asipctl({"list", "-o", "wide"}).output, HasSubstr("owner=Ann, Zoë,room=lab"));
    EXPECT_THAT(asipctl({"list", "services", "-o", "wide"}).output, HasSubstr("left arm"));
    EXPECT_EQ(asipctl({"pin", "desk", "status lamp", "high"}).output, "13 output high  status lamp\n");
    EXPECT_EQ(json::parse(asipctl({"pin", "desk", "13", "-o", "json"}).output)["label"], "status lamp");
    EXPECT_EQ(asipctl({"label", "-l", "room=lab", "room=hall", "owner-"}).status, 0);
    EXPECT_EQ(labels("desk"), "{\"room\":\"hall\"}\n");
    EXPECT_EQ(labels("old"), "{\"retired\":\"\",\"room\":\"hall\"}\n");
    const auto record = json::parse(asipctl({"label", "desk", "-o", "json"}).output);
    EXPECT_EQ(record, json::parse(R"([{"board":"desk","labels":{"room":"hall"},
        "names":{"services":{"servo":"left arm"},"pins":{"13":"status lamp"}}}])"));
}

TEST_F(LabelTest, LabelsOfTheConfiguration_AreThereAndADamagedFileIsKept) {
    ASSERT_NO_FATAL_FAILURE(start({"desk"}));
    kill_agent("desk");
    start_agent("desk", {"--label", "room=lab,floor=2", "--label", "pin.13=lamp"});
    ASSERT_TRUE(wait_state("desk", "online"));
    const auto changed = asipctl({"label", "desk", "room=hall"});
    EXPECT_EQ(changed.status, 1);
    EXPECT_THAT(changed.errors, HasSubstr("desk: the label room is set in the configuration"));
    EXPECT_EQ(labels("desk"), "{\"floor\":\"2\",\"room\":\"lab\"}\n");
    const auto wrong = run({ASIP_PROGRAMS "/asip-agent", "--serial", "/dev/x", "--label", "room"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.errors, HasSubstr("--label: \"room\" is not KEY=VALUE"));
    kill_agent("desk");
    std::filesystem::create_directories(folder_.path() / "state/labels");
    const auto file = folder_.write("state/labels/desk.json", "{\"labels\":{\"room\"");
    start_agent("desk");
    ASSERT_TRUE(wait_state("desk", "online"));
    EXPECT_THAT(agents_["desk"]->errors(), HasSubstr("labels cannot be read"));
    const auto shown = asipctl({"label", "desk"});
    EXPECT_EQ(shown.status, 1);
    EXPECT_THAT(shown.errors, HasSubstr("desk: labels that its agent kept cannot be read: " + file));
    EXPECT_THAT(shown.errors, Not(HasSubstr("no labels")));
    EXPECT_THAT(asipctl({"show", "desk"}).output, HasSubstr("cannot be read: " + file));
    EXPECT_EQ(json::parse(asipctl({"label", "desk", "-o", "json"}).output)[0].count("labels_fault"), 1U);
    EXPECT_EQ(asipctl({"label", "desk", "room-"}).status, 1);
    const auto set = asipctl({"label", "desk", "room=lab"});
    EXPECT_EQ(set.status, 0) << set.errors;
    EXPECT_THAT(set.errors, HasSubstr(file + ".damaged"));
    EXPECT_TRUE(std::filesystem::exists(file + ".damaged"));
    const auto again = asipctl({"label", "desk"});
    EXPECT_EQ(again.status, 0) << again.errors;
    EXPECT_THAT(again.output, HasSubstr("room  lab"));
}

TEST_F(LabelTest, OneOfTheBoards_RefusesOrIsAwayAndIsLeftOutOfWhatIsHeard) {
    ASSERT_NO_FATAL_FAILURE(start({"desk", "old"}));
    ASSERT_EQ(asipctl({"label", "desk", "room=lab"}).status, 0);
    for (const char* board : {"desk/io", "old/io"}) {
        const auto sent = asipctl({"send", board, "report", "50"});
        ASSERT_EQ(sent.status, 0) << sent.errors;
    }
    const auto heard = asipctl({"subscribe", "-l", "room=lab", "-n", "5", "-W", "20"});
    EXPECT_EQ(heard.status, 0) << heard.errors;
    EXPECT_THAT(heard.output, HasSubstr("desk/io"));
    EXPECT_THAT(heard.output, Not(HasSubstr("old/io")));
    EXPECT_EQ(asipctl({"subscribe"}).status, 2);
    const auto sent = asipctl({"send", "*", "--raw", "S,W,9,90", "--from-bus"});
    EXPECT_EQ(sent.status, 1);
    EXPECT_THAT(sent.output, HasSubstr("INVALID_DEVICE_NUMBER"));
    EXPECT_THAT(sent.errors, HasSubstr("0 of 2 boards executed it"));
    kill_agent("old");
    const auto half = asipctl({"send", "*/servo", "write", "0", "90", "--from-bus"});
    EXPECT_EQ(half.status, 1);
    EXPECT_THAT(half.output, MatchesRegex("BOARD +RESULT +ANSWER\ndesk +ok *\nold +refused +it is lost.*\n"));
    EXPECT_THAT(half.errors, HasSubstr("1 of 2 boards executed it"));
    probe_.clear();
    const auto wrong = asipctl({"send", "*/servo", "write", "0", "900", "--from-bus"});
    EXPECT_EQ(wrong.status, 2) << "nothing is sent where it is wrong";
    EXPECT_EQ(probe_.count("asip/desk/servo/in"), 0u);
}

TEST_F(LabelTest, WhatCannotBeLabelled_IsToldWithWhatToWrite) {
    ASSERT_NO_FATAL_FAILURE(start({"desk"}));
    probe_.publish("asip/servicebus", "paper", false);
    probe_.publish("asip/servicebus/paper", "light", false);
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment());
    ASSERT_TRUE(registry.wait_for_errors("catalogue is complete"));
    probe_.publish("asip/servicebus", "paper", false);
    ASSERT_TRUE(wait_until([this] { return names_of({"--board", "paper"}) == "paper\n"; }));
    const auto set = asipctl({"label", "paper", "room=lab"});
    EXPECT_EQ(set.status, 1);
    EXPECT_THAT(set.errors, HasSubstr("known by its names only: it has no agent that keeps labels"));
    const auto all = asipctl({"label", "*", "room=lab", "-o", "jsonl"});
    EXPECT_EQ(all.status, 1);
    EXPECT_THAT(all.errors, HasSubstr("paper: it is known by its names only"));
    EXPECT_THAT(all.output, HasSubstr(R"("board":"desk")"));
    EXPECT_EQ(labels("desk"), "{\"room\":\"lab\"}\n") << "the others are labelled all the same";
    const auto why = [this](Words words) {
        words.insert(words.begin(), "label");
        const auto done = asipctl(words);
        EXPECT_EQ(done.status, 2) << done.errors;
        return done.errors;
    };
    EXPECT_THAT(why({"room=lab"}), HasSubstr("asipctl label BOARD room=lab"));
    EXPECT_THAT(why({"desk", "room"}), HasSubstr("write KEY=VALUE"));
    EXPECT_THAT(why({"desk/servo", "room=lab"}), HasSubstr("only its name"));
    EXPECT_THAT(why({"desk/*", "name=x"}), HasSubstr("name one service"));
    EXPECT_THAT(why({"desk", "pin.999=x"}), HasSubstr("is not a pin"));
    EXPECT_THAT(why({"desk*", "pin.A0=arm"}), HasSubstr("of several boards write the number"));
    EXPECT_THAT(why({"desk/io/2", "name=x"}), HasSubstr("asipctl label BOARD pin.A0=NAME"));
    const auto none = asipctl({"label", "dest", "room=lab"});
    EXPECT_EQ(none.status, 4);
    EXPECT_THAT(none.errors, HasSubstr("did you mean \"desk\"?"));
    EXPECT_EQ(asipctl({"label", "desk/sevo", "name=x"}).status, 1);
    EXPECT_EQ(asipctl({"label", "desk", "pin.99=x"}).status, 1) << "the agent knows how many it has";
}

}  // namespace
}  // namespace asip::test
