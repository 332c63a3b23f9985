// What asipctl makes of the bus when no registry runs.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

TEST(NoBroker, AnyCommand_EndsWithStatus3AndSaysWhere) {
    const auto address = "127.0.0.1:" + std::to_string(free_port());
    const auto list = run({ASIP_PROGRAMS "/asipctl", "list", "--broker", address});
    EXPECT_EQ(list.status, 3);
    EXPECT_THAT(list.errors, HasSubstr(address));
    EXPECT_THAT(list.output, IsEmpty());
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

TEST_F(BusTest, NoRegistry_ListReadsTheBusAndSaysSo) {
    announce("uno1");
    announce("uno2", "lost");
    const auto list = asipctl({"list"});
    EXPECT_EQ(list.status, 0);
    EXPECT_THAT(list.output, HasSubstr("uno1   online  ATmega328P  AsipHello  io distance servo X"));
    EXPECT_THAT(list.output, HasSubstr("uno2   lost"));
    EXPECT_THAT(list.output, Not(HasSubstr("\033["))) << "no colours but on a terminal";
    EXPECT_THAT(list.errors, HasSubstr("no registry"));
    EXPECT_THAT(asipctl({"list", "--from-bus", "--state", "lost", "-o", "name"}).output, "uno2\n");
    EXPECT_THAT(asipctl({"list", "--from-bus"}).errors, IsEmpty());
}

TEST_F(BusTest, ServicesAsJson_CanBeReadByPrograms) {
    announce("uno1");
    const auto list = asipctl({"list", "services", "--from-bus", "--unit", "cm", "-o", "json"});
    const auto document = nlohmann::json::parse(list.output);
    ASSERT_EQ(document.size(), 1U);
    EXPECT_EQ(document[0]["board"], "uno1");
    EXPECT_EQ(document[0]["name"], "distance");
    EXPECT_EQ(document[0]["count"], 2);
}

TEST_F(BusTest, EmptyBus_ListsNothingAndSucceeds) {
    const auto list = asipctl({"list", "-o", "json"});
    EXPECT_EQ(list.status, 0);
    EXPECT_EQ(list.output, "[]\n");
}

TEST_F(BusTest, UnknownBoard_EndsWithStatus4AndTheNearestName) {
    announce("kitchen");
    const auto show = asipctl({"show", "kitchne"});
    EXPECT_EQ(show.status, 4);
    EXPECT_THAT(show.errors, HasSubstr("did you mean \"kitchen\""));
    EXPECT_EQ(asipctl({"show", "kitchen/serov"}).status, 1);
}

TEST_F(BusTest, WatchedList_ShowsWhatChanges) {
    announce("uno1");
    ChildProcess watch(program({"list", "-w", "--from-bus"}), environment());
    ASSERT_TRUE(watch.wait_for_output("^uno1 +online"));
    announce("uno1", "lost");
    EXPECT_TRUE(watch.wait_for_output("^uno1 +lost"));
    announce("uno2");
    EXPECT_TRUE(watch.wait_for_output("^uno2 +online"));
    watch.signal(SIGINT);
    EXPECT_EQ(watch.wait_exit(), 0);
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

TEST_F(BusTest, SubscribeToSilence_EndsInTimeWithStatus4) {
    announce("uno1");
    EXPECT_EQ(asipctl({"subscribe", "uno1/distance", "-W", "200ms"}).status, 4);
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

TEST_F(BusTest, Prune_ClearsWhatLingersAndNothingElse) {
    announce("uno1");
    announce("dead", "lost");
    probe_.publish("asip/uno1/servo/in", "W,0,90", true);
    probe_.publish("asip/notes/of/somebody", "keep", true);
    const auto dry = asipctl({"prune", "--dry-run", "-o", "name"});
    EXPECT_EQ(dry.output,
              "asip/servicebus/dead/$description\nasip/servicebus/dead/$state\nasip/uno1/servo/in\n");
    EXPECT_EQ(asipctl({"prune", "--only", "commands", "-o", "name"}).output, "asip/uno1/servo/in\n");
    EXPECT_EQ(asipctl({"prune"}).status, 0);
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
    EXPECT_THAT(doctor.output, HasSubstr("problem  ghost is said to be online, but nobody answers"));
    EXPECT_THAT(doctor.output,
                HasSubstr("retained commands, delivered again at each reconnection: asip/ghost/in"));
    EXPECT_THAT(doctor.output, HasSubstr("a b"));
    EXPECT_THAT(doctor.output, HasSubstr("-> asipctl prune --only commands"));
}

TEST(Doctor, BrokerWithoutTcpNodelay_IsNoticed) {
    MosquittoBroker::Options options;
    options.extra_lines = {"set_tcp_nodelay false"};
    MosquittoBroker broker(options);
    const auto doctor = run({ASIP_PROGRAMS "/asipctl", "doctor", "--broker", broker.address()});
    EXPECT_THAT(doctor.output, HasSubstr("set_tcp_nodelay true"));
    MosquittoBroker good;
    EXPECT_THAT(run({ASIP_PROGRAMS "/asipctl", "doctor", "--broker", good.address()}).output,
                HasSubstr("takes us (MQTT 5)"));
}

TEST_F(BusTest, Completion_OffersLiveNames) {
    announce("uno1");
    EXPECT_EQ(asipctl({"__complete", "1", "show", "u"}).output, "uno1\nuno1/\n");
    EXPECT_EQ(asipctl({"__complete", "1", "send", "uno1/s"}).output, "uno1/servo\n");
    EXPECT_EQ(asipctl({"__complete", "2", "send", "uno1/servo", ""}).output, "remap\nwrite\n");
}

TEST(CompletionScript, Bash_IsAccepted) {
    const auto script = run({ASIP_PROGRAMS "/asipctl", "completion", "bash"});
    ASSERT_EQ(script.status, 0);
    EXPECT_EQ(run({"bash", "-n", "-c", script.output}).status, 0);
    const auto completed = run({"bash", "-c", script.output + R"(
PATH=)" ASIP_PROGRAMS R"(:$PATH; COMP_WORDS=(asipctl sub); COMP_CWORD=1; _asipctl; echo "${COMPREPLY[@]}")"});
    EXPECT_EQ(completed.output, "subscribe\n");
}

}  // namespace
}  // namespace asip::test
