// SPDX-License-Identifier: Apache-2.0
// What asipctl makes of the bus when no registry runs.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(NoBroker, AnyCommand_EndsWithStatus3AndSaysWhere) {
    const auto address = "127.0.0.1:" + std::to_string(free_port());
    const auto list = run({ASIP_PROGRAMS "/asipctl", "list", "--broker", address});
    EXPECT_EQ(list.status, 3);
    EXPECT_THAT(list.errors, HasSubstr(address));
    EXPECT_THAT(list.output, IsEmpty());
}

TEST_F(BusTest, FirstBrokerOfTheListIsOfNoUse_UsesTheSecond) {
    announce("uno1");
    MosquittoBroker refusing({.users = {{"ada", "right"}}});
    const TempDir folder;
    for (const auto& first : {refusing.address(), "127.0.0.1:" + std::to_string(free_port())}) {
        const auto list =
            run({ASIP_PROGRAMS "/asipctl", "list", "--from-bus", "-o", "name", "--broker", first, "--broker",
                 broker_.address(), "--user", "ada", "--password-file", folder.write("password", "wrong\n")});
        EXPECT_EQ(list.status, 0) << list.errors;
        EXPECT_EQ(list.output, "uno1\n");
    }
}

/// Others on the machine see it among the arguments.
TEST(WrongUse, PasswordOnTheCommandLine_IsRefusedByEachProgram_AndNotShown) {
    for (const auto* program : {"/asipctl", "/asip-agent", "/asip-registry", "/asip-gateway"}) {
        std::vector<std::string> words{ASIP_PROGRAMS + std::string(program)};
        if (program == std::string("/asipctl")) words.emplace_back("list");
        for (const auto* word : {"--user", "ada", "--password", "hunter2"})
            words.emplace_back(word);
        const auto finished = run(words);
        EXPECT_EQ(finished.status, 2) << program;
        EXPECT_THAT(finished.errors, HasSubstr("ASIP_PASSWORD")) << program;
        EXPECT_THAT(finished.errors, Not(HasSubstr("hunter2"))) << program;
    }
}

TEST(WrongUse, EachEndsWithStatus2) {
    for (const auto& arguments : std::vector<std::vector<std::string>>{{"lits"},
                                                                       {"list", "everything"},
                                                                       {"show"},
                                                                       {"send", "uno 1/servo", "write"},
                                                                       {"pin", "uno1", "13", "hihg"}}) {
        auto words = arguments;
        words.insert(words.begin(), ASIP_PROGRAMS "/asipctl");
        const auto finished = run(words);
        EXPECT_EQ(finished.status, 2) << finished.errors;
        EXPECT_THAT(finished.errors, Not(IsEmpty()));
    }
}

TEST_F(BusTest, NoRegistry_ListReadsTheBusAndReportsThat) {
    announce("uno1");
    announce("uno2", "lost");
    const auto list = asipctl({"list"});
    EXPECT_EQ(list.status, 0);
    EXPECT_THAT(list.output,
                testing::ContainsRegex("uno1   online +ATmega328P  AsipHello  io distance servo X"));
    EXPECT_THAT(list.output, HasSubstr("uno2   lost"));
    EXPECT_THAT(list.output, Not(HasSubstr("\033["))) << "no colours but on a terminal";
    EXPECT_THAT(list.errors, HasSubstr("no registry"));
    EXPECT_THAT(asipctl({"list", "--from-bus", "--state", "lost", "-o", "name"}).output, "uno2\n");
    EXPECT_THAT(asipctl({"list", "--from-bus"}).errors, IsEmpty());
}

TEST_F(BusTest, UnknownBoard_EndsWithStatus4AndTheNearestName) {
    announce("kitchen");
    const auto show = asipctl({"show", "kitchne"});
    EXPECT_EQ(show.status, 4);
    EXPECT_THAT(show.errors, HasSubstr("did you mean \"kitchen\""));
    EXPECT_EQ(asipctl({"show", "kitchen/serov"}).status, 1);
}

TEST_F(BusTest, Subscribe_PrintsDecodedValuesAndEndsByCount) {
    announce("uno1");
    ChildProcess subscribe(
        program({"subscribe", "uno*/distance", "-n", "2", "--format", "{where} {data.distance.1}"}),
        environment());
    ASSERT_TRUE(wait_until([&] {
        probe_.publish("asip/uno1/servo/out", "{}");
        probe_.publish("asip/uno1/distance/out", R"({"distance":[42,118]})");
        return !subscribe.running();
    }));
    EXPECT_EQ(subscribe.wait_exit(), 0);
    EXPECT_EQ(subscribe.output(), "uno1/distance 118\nuno1/distance 118\n");
}

TEST_F(BusTest, ForgetABoardThatIsGone_EmptiesEveryTopicOfItAndNoOther) {
    announce("dead", "lost");
    announce("dead2", "lost");
    probe_.publish("asip/dead/distance/out", "{}", true);
    const auto dry = asipctl({"forget", "dead", "--dry-run"});
    EXPECT_EQ(dry.output,
              "asip/dead/distance/out\nasip/servicebus/dead/$description\nasip/servicebus/dead/$state\n");
    const auto forget = asipctl({"forget", "dead"});
    EXPECT_EQ(forget.status, 0) << forget.errors;
    EXPECT_EQ(forget.output, dry.output);
    BusProbe late(broker_.port());
    EXPECT_TRUE(late.wait_for("asip/servicebus/dead2/$state", "lost"));
    EXPECT_EQ(late.count("asip/servicebus/dead/$state"), 0U);
    EXPECT_EQ(late.count("asip/dead/distance/out"), 0U);
    EXPECT_EQ(asipctl({"forget", "dead"}).status, 1) << "nothing is left to forget";
}

TEST_F(BusTest, ForgetABoardThatAnswers_IsRefused) {
    announce("uno1");
    ChildProcess forget(program({"forget", "uno1"}), environment());
    const auto request = probe_.wait_for("asip/uno1/in");
    ASSERT_TRUE(request);
    answer(*request, R"({"status":"ok","proof":"answer"})");
    EXPECT_EQ(forget.wait_exit(), 1);
    EXPECT_THAT(forget.errors(), HasSubstr("alive"));
    EXPECT_TRUE(BusProbe(broker_.port()).wait_for("asip/servicebus/uno1/$state", "online"));
}

TEST_F(BusTest, ForgetSeveralAndPatterns_TakesThoseThatAreGone) {
    for (const auto* board : {"old-1", "old-2", "kitchen", "hall"})
        announce(board, "lost");
    announce("old-3");
    const auto dry = asipctl({"forget", "old-*", "hall", "--dry-run", "-o", "jsonl"});
    EXPECT_EQ(dry.status, 0) << dry.errors;
    EXPECT_THAT(dry.errors, HasSubstr("not gone, left alone: old-3"));
    EXPECT_THAT(dry.errors, HasSubstr("would forget 3 boards: 6 retained topics"));
    EXPECT_THAT(dry.output, HasSubstr(R"({"board":"hall","topic":"asip/servicebus/hall/$state"})"));
    EXPECT_THAT(dry.output, Not(HasSubstr("kitchen")));
    EXPECT_TRUE(BusProbe(broker_.port()).wait_for("asip/servicebus/old-1/$state", "lost"));

    EXPECT_EQ(asipctl({"forget", "hall", "old-*/servo"}).status, 2) << "and nothing is done";
    const auto named = asipctl({"forget", "nobody", "hall", "attic-*"});
    EXPECT_EQ(named.status, 1) << "one is unknown, and the other is done";
    EXPECT_EQ(named.output, "asip/servicebus/hall/$description\nasip/servicebus/hall/$state\n");
    EXPECT_THAT(named.errors, HasSubstr("unknown board \"nobody\""));
    EXPECT_THAT(named.errors, HasSubstr("no board is like attic-*"));
    EXPECT_THAT(named.errors, HasSubstr("forgot hall: 2 retained topics cleared"));
    EXPECT_EQ(asipctl({"forget", "old-*", "old-1"}).status, 0);
    const BusProbe late(broker_.port());
    EXPECT_TRUE(late.wait_for("asip/servicebus/kitchen/$state", "lost"));
    EXPECT_TRUE(late.wait_for("asip/servicebus/old-3/$state", "online"));
    EXPECT_EQ(late.count("asip/servicebus/old-1/$state"), 0U);
    EXPECT_EQ(late.count("asip/servicebus/old-2/$state"), 0U);
}

TEST_F(BusTest, Prune_ClearsWhatLingersAndNothingElse) {
    announce("uno1");
    announce("dead", "lost");
    probe_.publish("asip/uno1/servo/in", "W,0,90", true);
    probe_.publish("asip/notes/of/somebody", "keep", true);
    const auto dry = asipctl({"forget", "--leftovers", "--dry-run", "-o", "name"});
    EXPECT_EQ(dry.output,
              "asip/servicebus/dead/$description\nasip/servicebus/dead/$state\nasip/uno1/servo/in\n");
    EXPECT_EQ(asipctl({"forget", "--leftovers", "--only", "commands", "-o", "name"}).output,
              "asip/uno1/servo/in\n");
    EXPECT_EQ(asipctl({"forget", "--leftovers"}).status, 0);
    BusProbe late(broker_.port());
    EXPECT_TRUE(late.wait_for("asip/notes/of/somebody", "keep"));
    EXPECT_TRUE(late.wait_for("asip/servicebus/uno1/$state", "online"));
    EXPECT_EQ(late.messages().size(), 3U);
}

TEST_F(BusTest, Doctor_NamesEachFaultAndWhatToDo) {
    announce("ghost");
    probe_.publish("asip/ghost/in", "#,R", true);
    probe_.publish("asip/servicebus/a b/$state", "online", true);
    const auto doctor = asipctl({"doctor", "--timeout", "1s"});
    EXPECT_EQ(doctor.status, 1);
    EXPECT_THAT(doctor.output, HasSubstr("note     no registry runs"));
    EXPECT_THAT(doctor.output, Not(HasSubstr("our clock")));
    EXPECT_THAT(doctor.output, HasSubstr("problem  ghost is reported online, but nothing answers"));
    EXPECT_THAT(doctor.output,
                HasSubstr("retained commands, delivered again at each reconnection: asip/ghost/in"));
    EXPECT_THAT(doctor.output, HasSubstr("a b"));
    EXPECT_THAT(doctor.output, HasSubstr("-> asipctl forget --leftovers --only commands"));
}

TEST_F(BusTest, DoctorWithoutARegistry_WaitsForNone) {
    const auto doctor = run(program({"doctor", "--timeout", "600s"}), environment(), time_limit(60s));
    EXPECT_EQ(doctor.status, 0) << doctor.errors;
    EXPECT_THAT(doctor.output, HasSubstr("note     no registry runs"));
    EXPECT_THAT(doctor.errors, IsEmpty());
}

/// Waits until a program that can print nothing more has ended.
TEST_F(BusTest, UnreadableDescription_IsClearedByWhatTheDoctorAdvises) {
    announce("uno1");
    probe_.publish("asip/servicebus/broken/$description", "{", true);
    probe_.publish("asip/servicebus/broken/$state", "online", true);
    const auto doctor = asipctl({"doctor", "--timeout", "1s"});
    EXPECT_THAT(doctor.output, HasSubstr("asip/servicebus/broken/$description cannot be read"));
    EXPECT_THAT(doctor.output, HasSubstr("asipctl forget --leftovers --only documents"));
    EXPECT_EQ(asipctl({"forget", "--leftovers", "--only", "documents", "-o", "name"}).output,
              "asip/servicebus/broken/$description\n");
    EXPECT_THAT(asipctl({"doctor", "--timeout", "1s"}).output, Not(HasSubstr("cannot be read")));
}

TEST_F(BusTest, ForgetABoardThatNobodyKnows_FailsWithTheNearest) {
    announce("kitchen", "lost");
    ChildProcess registry({ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment());
    ASSERT_TRUE(probe_.wait_for("asip/registry/r1/$state", "online"));
    const auto forget = asipctl({"forget", "kitchne"});
    EXPECT_EQ(forget.status, 1);
    EXPECT_THAT(forget.errors, HasSubstr("did you mean \"kitchen\""));
    EXPECT_THAT(forget.errors, Not(HasSubstr("forgot")));
}

TEST_F(BusTest, ReaderThatHasGone_EndsWhateverRuns) {
    announce("uno1");
    for (const auto* command : {"subscribe uno1", "ping uno1 -n 0"}) {
        ChildProcess pipe(
            {"bash", "-c", std::string(ASIP_PROGRAMS "/asipctl ") + command + " | head -c 1 > /dev/null"},
            environment());
        // Something to read for `head`; the board then says nothing more.
        ASSERT_TRUE(wait_until([&] {
            probe_.publish("asip/uno1/distance/out", "{}");
            if (const auto request = probe_.wait_for("asip/uno1/in", std::chrono::milliseconds(10)))
                answer(*request, R"({"status":"ok","proof":"fence"})");
            return !pipe.running();
        })) << command;
    }
}

TEST_F(BusTest, DiskThatIsFull_IsAFailure) {
    announce("uno1");
    for (const auto* command :
         {"list --from-bus", "show uno1", "list --from-bus -o json", "--help", "completion bash"}) {
        const auto finished = run(
            {"bash", "-c", std::string(ASIP_PROGRAMS "/asipctl ") + command + " > /dev/full"}, environment());
        EXPECT_EQ(finished.status, 1) << command;
        EXPECT_THAT(finished.errors, HasSubstr("cannot write the output")) << command;
    }
}

TEST(CompletionScript, Bash_IsAccepted) {
    const auto script = run({ASIP_PROGRAMS "/asipctl", "completion", "bash"});
    ASSERT_EQ(script.status, 0);
    EXPECT_EQ(run({"bash", "-n", "-c", script.output}).status, 0);
    const auto completed = run({"bash", "-c", script.output + R"(
PATH=)" ASIP_PROGRAMS R"(:$PATH
complete_line() { COMP_LINE=$1; COMP_POINT=${#1}; _asipctl asipctl; echo "${COMPREPLY[@]}"; }
complete_line 'asipctl sub'
complete_line 'asipctl --broker 127.0.0.1:1 li'
complete_line 'asipctl list --state o'
complete_line 'asipctl list --state x')"});
    EXPECT_EQ(completed.output, "subscribe\nlink list\noffline online\n\n");
}

}  // namespace
}  // namespace asip::test
