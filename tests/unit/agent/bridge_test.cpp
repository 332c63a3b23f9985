#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/client_framing.hpp"
#include "agent/outage.hpp"
#include "agent/recent_answers.hpp"
#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct OnlineBridge : testing::Test {
    OnlineBridge() {
        bench.go_online();
        bench.published.clear();
        bench.board.executed.clear();
    }
    BridgeBench bench;
};

// --- a board that does not answer

TEST(NoAnswer, NoBoardEverIdentified_EndsTheProgram) {
    BridgeBench bench;
    bench.board.mute = true;
    bench.plug();
    bench.pass(10s);
    ASSERT_TRUE(bench.fatal);
    EXPECT_EQ(bench.fatal->status, 5);
    EXPECT_THAT(bench.fatal->text, HasSubstr("does not answer"));
}

TEST_F(OnlineBridge, ReplacedByABoardThatIsMute_WarnsAndGoesOnAsking) {
    bench.unplug();
    bench.board.mute = true;
    bench.plug();
    bench.pass(60s);
    EXPECT_FALSE(bench.fatal);
    EXPECT_EQ(std::count_if(bench.notices.begin(), bench.notices.end(),
                            [](const auto& n) { return n.find("does not answer") != n.npos; }),
              1);
    bench.board.mute = false;
    bench.pass(10s);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "online");
}

TEST_F(OnlineBridge, SilentForLongWithoutUnplugging_IsNeverFatal) {
    bench.board.mute = true;
    bench.pass(60s);
    EXPECT_FALSE(bench.fatal);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "lost");
    bench.board.mute = false;
    bench.pass(10s);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "online");
}

// --- context

TEST_F(OnlineBridge, EventOfTheBoard_IsPublishedRawAndDecoded) {
    bench.say("@D,e,2,{42,118}\r\n");
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,2,{42,118}"));
    EXPECT_THAT(bench.on("asip/uno1/distance/out"), ElementsAre(R"({"distance":[42,118]})"));
    EXPECT_THAT(bench.client_lines, ElementsAre("@D,e,2,{42,118}"));
}

TEST_F(OnlineBridge, DigitalEvent_NamesThePinsOfThePort) {
    bench.say("@I,d,4,4\r\n");
    ASSERT_EQ(bench.on("asip/uno1/io/out").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("asip/uno1/io/out")[0])["digital"]["2"], 1);
}

TEST_F(OnlineBridge, ErrorOfTheBoard_IsPublishedForItsService) {
    bench.say("~S,W,7{INVALID_DEVICE_NUMBER}\r\n");
    ASSERT_EQ(bench.on("asip/uno1/servo/error").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("asip/uno1/servo/error")[0]),
              json::parse(R"({"request":"W","code":7,"error":"INVALID_DEVICE_NUMBER"})"));
}

TEST_F(OnlineBridge, EventThatFitsNoModel_IsPublishedRawOnly) {
    bench.say("@D,e,3,{42\r\n@Z,z,1\r\n");
    EXPECT_EQ(bench.on("asip/uno1/out").size(), 2u);
    EXPECT_EQ(bench.published.size(), 2u);
}

TEST_F(OnlineBridge, ElementsSeen_AreCountedInTheDescription) {
    bench.say("@D,e,2,{42,118}\r\n");
    bench.pass(1s);
    const auto descriptions = bench.on("asip/servicebus/uno1/$description");
    ASSERT_EQ(descriptions.size(), 1u);
    EXPECT_EQ(model::parse_description(descriptions[0])->service("distance")->count, 2);
}

TEST_F(OnlineBridge, ModeAndPeriodSet_AreInTheDescription) {
    bench.ask("asip/uno1/io/in", {{"mode", {3, "output"}}}, "1");
    bench.ask("asip/uno1/distance/in", {{"report", 100}}, "2");
    bench.pass(1s);
    const auto descriptions = bench.on("asip/servicebus/uno1/$description");
    ASSERT_EQ(descriptions.size(), 1u) << "one announcement for both";
    const auto description = model::parse_description(descriptions[0]);
    EXPECT_EQ(description->pins.modes, "661377");
    EXPECT_EQ(description->service("distance")->period, 100);
}

TEST_F(OnlineBridge, BusAway_NewestValueOfEachKindIsPublishedWhenItIsBack) {
    bench.bridge.bus_disconnected();
    for (const char* line : {"@D,e,1,{1}\n", "@I,d,4,4\n", "@D,e,1,{2}\n", "@I,d,3,0\n", "@D,e,1,{3}\n"})
        bench.say(line);
    EXPECT_THAT(bench.on("asip/uno1/out"), IsEmpty());
    bench.connect();
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,1,{3}", "@I,d,3,0", "@I,d,4,4"));
}

TEST(Claim, NameNotYetOurs_NothingIsPublishedOrExecuted) {
    BridgeBench bench;
    bench.plug();
    bench.connect();
    bench.board.executed.clear();
    bench.say("@D,e,1,{42}\n");
    bench.hear("asip/uno1/in", "I,d,13,1");
    EXPECT_THAT(bench.on("asip/uno1/out"), IsEmpty());
    EXPECT_THAT(bench.board.executed, IsEmpty());
    bench.pass(1500ms);
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,1,{42}"));
}

TEST(Context, TerminatorAndRetainWanted_AreUsed) {
    auto options = BridgeBench::defaults();
    options.context = {"\r\n", true};
    BridgeBench bench(options);
    bench.go_online();
    bench.say("@D,e,1,{42}\r\n");
    EXPECT_THAT(bench.on("asip/uno1/out"), ElementsAre("@D,e,1,{42}\r\n"));
    bool retained = false;
    for (const auto& p : bench.published)
        retained = retained || (p.message.topic == "asip/uno1/distance/out" && p.message.retain);
    EXPECT_TRUE(retained);
}

// --- control

TEST_F(OnlineBridge, Command_IsExecutedAndAnsweredWithItsProof) {
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}),
              json::parse(R"({"id":"1","status":"ok","proof":"fence"})"));
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90"));
}

TEST_F(OnlineBridge, CommandWithAnAnswer_CarriesItDecoded) {
    bench.board.replies["D,M"] = "@D,e,2,{42,118}";
    EXPECT_EQ(bench.ask("asip/uno1/distance/in", {{"measure", nullptr}})["answer"],
              json::parse(R"({"distance":[42,118]})"));
}

TEST_F(OnlineBridge, BoardRefuses_ItsWordsAreTheAnswer) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {9, 90}}}),
              json::parse(R"({"id":"1","status":"error","code":7,"error":"INVALID_DEVICE_NUMBER"})"));
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "2")["status"], "ok");
}

TEST_F(OnlineBridge, BoardDoesNotAnswer_TimeoutAndTheNextWorks) {
    bench.board.swallow_fences = 1;
    EXPECT_TRUE(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}).is_null());
    bench.say("@I,a,1,{0:1}\r\n");
    bench.pass(1s);
    bench.say("@I,a,1,{0:1}\r\n");
    bench.pass(1s);
    ASSERT_EQ(bench.on("answers").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("answers")[0])["status"], "timeout");
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "2")["status"], "ok");
}

TEST_F(OnlineBridge, BadCommands_AreRefusedWithAReasonAndNothingIsSent) {
    int id = 0;
    for (const char* command : {R"({"wirte":[0,90]})", R"({"write":[0]})", R"({"write":[0,900]})",
                                R"({"write":["x",1]})", R"({"write":{"servo":0,"ankle":90}})", R"({})"}) {
        const auto answer =
            bench.ask("asip/uno1/servo/in", json::parse(command), "bad" + std::to_string(++id));
        EXPECT_EQ(answer["status"], "refused") << command;
        EXPECT_EQ(answer["reason"], "invalid") << command;
        EXPECT_FALSE(answer["error"].get<std::string>().empty()) << command;
    }
    EXPECT_THAT(bench.board.executed, IsEmpty());
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}})["status"], "ok");
}

TEST_F(OnlineBridge, ServiceTheBoardDoesNotHave_IsRefused) {
    EXPECT_EQ(bench.ask("asip/uno1/tone/in", {{"play", {440, 100}}})["status"], "refused");
}

TEST_F(OnlineBridge, TextAndRawLines_AreExecuted) {
    bench.hear("asip/uno1/servo/in", "W,0,90");
    bench.hear("asip/uno1/in", "I,d,13,1\nI,d,13,0\r\n");
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90", "I,d,13,1", "I,d,13,0"));
}

TEST_F(OnlineBridge, ManyLinesInOnePayload_OneAnswerWithTheFirstError) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    const auto answer = bench.ask("asip/uno1/in", {{"raw", "I,d,13,1\nS,W,9,90\nI,d,13,0"}});
    EXPECT_EQ(answer["code"], 7);
    EXPECT_EQ(bench.on("answers").size(), 1u);
    EXPECT_EQ(bench.board.executed.size(), 3u);
}

TEST_F(OnlineBridge, RetainedCommand_IsRefusedAndNotSent) {
    bench.hear("asip/uno1/servo/in", R"({"write":[0,90],"id":"1","reply_to":"answers"})", true);
    bench.hear("asip/uno1/in", "I,d,13,1", true);
    ASSERT_EQ(bench.on("answers").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("answers")[0])["reason"], "retained");
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(OnlineBridge, SameIdWithinAMinute_IsAnsweredAgainNotExecutedAgain) {
    const auto first = bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "a");
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "a"), first);
    EXPECT_EQ(bench.board.executed.size(), 1u);
    EXPECT_EQ(bench.on("answers").size(), 2u);
    bench.pass(61s);
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "a");
    EXPECT_EQ(bench.board.executed.size(), 2u);
}

TEST_F(OnlineBridge, SameIdWithAnotherCommand_IsRefusedAndNotExecuted) {
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "a");
    const auto other = bench.ask("asip/uno1/servo/in", {{"write", {0, 10}}}, "a");
    EXPECT_EQ(other["status"], "refused");
    EXPECT_EQ(other["reason"], "id-reused");
    EXPECT_EQ(bench.ask("asip/uno1/distance/in", {{"report", 100}}, "a")["status"], "ok") << "another topic";
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90", "D,A,100"));
}

TEST_F(OnlineBridge, Refused_IsTriedAgainUnderTheSameId) {
    bench.unplug();
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "a")["reason"], "board-not-there");
    bench.plug();
    bench.pass(1s);
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "a")["status"], "ok");
}

TEST_F(OnlineBridge, IdRepeatedAfterTenThousandOthers_IsStillKnown) {
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "first");
    for (int i = 0; i < 10'000; ++i) {
        bench.ask("asip/uno1/servo/in", {{"write", {0, 80}}}, std::to_string(i));
        bench.published.clear();
    }
    bench.board.executed.clear();
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "first")["status"], "ok");
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

// --- one answer, in time

TEST_F(OnlineBridge, BoardMute_EachCommandIsAnsweredAtItsDeadline) {
    bench.board.mute = true;
    bench.hear("asip/uno1/servo/in", R"({"write":[0,90],"id":"1","reply_to":"answers","deadline_ms":200})");
    bench.hear("asip/uno1/servo/in", R"({"write":[0,91],"id":"2","reply_to":"answers","deadline_ms":200})");
    bench.pass(200ms);
    EXPECT_EQ(bench.on("answers").size(), 2u);
    mqtt::Message expiring;
    expiring.topic = "asip/uno1/servo/in";
    expiring.payload = R"({"write":[0,92],"id":"3","reply_to":"answers"})";
    expiring.expiry_seconds = 1;
    bench.hear(expiring);
    bench.pass(1s);
    EXPECT_EQ(bench.on("answers").size(), 3u);
}

TEST_F(OnlineBridge, DeadlineOutOfRange_IsRefused) {
    for (const char* deadline : {"49", "60001", "-1", "1.5", "\"100\""}) {
        bench.hear("asip/uno1/servo/in",
                   std::string(R"({"write":[0,90],"reply_to":"answers","deadline_ms":)") + deadline + "}");
        EXPECT_EQ(json::parse(bench.on("answers").back())["reason"], "invalid") << deadline;
    }
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(OnlineBridge, BoardDiesAfterItsBanner_IsLostAndAllIsAnsweredAndNothingRunsLater) {
    bench.board.mute = true;
    bench.say(bench.board.banner());
    for (int i = 0; i < 8; ++i)
        bench.ask("asip/uno1/servo/in", {{"write", {0, i}}}, std::to_string(i));
    bench.pass(6s);
    EXPECT_EQ(bench.on("answers").size(), 8u);
    EXPECT_EQ(bench.on("asip/servicebus/uno1/$state").back(), "lost");
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 9}}}, "9")["reason"], "board-not-there");
    bench.board.mute = false;
    bench.pass(30s);
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(OnlineBridge, LinkBackToAMuteBoard_CommandsAreRefusedAndNoneRunsLater) {
    bench.unplug();
    bench.board.mute = true;
    bench.plug();
    for (int i = 0; i < 600; ++i)
        EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, std::to_string(i))["reason"],
                  "board-not-there");
    bench.board.mute = false;
    bench.pass(30s);
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(OnlineBridge, SomeLinesSentAndOthersNot_IsNotCalledRefused) {
    bench.board.mute = true;
    bench.ask("asip/uno1/in",
              {{"raw", "S,W,0,1\nS,W,0,2\nS,W,0,3\nS,W,0,4\nS,W,0,5\nS,W,0,6\nS,W,0,7\nS,W,0,8"}});
    bench.pass(6s);
    ASSERT_EQ(bench.on("answers").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("answers")[0])["status"], "timeout");
}

TEST_F(OnlineBridge, MoreLinesThanThereIsRoomFor_NoneIsSent) {
    bench.board.mute = true;
    std::string lines;
    for (int i = 0; i < 60; ++i)
        lines += "S,W,0," + std::to_string(i) + "\n";
    bench.hear("asip/uno1/in", lines);
    bench.hear("asip/uno1/in", lines);
    bench.board.mute = false;
    bench.pass(5s);
    EXPECT_LE(std::count(bench.board.executed.begin(), bench.board.executed.end(), "S,W,0,59"), 1);
    EXPECT_LE(std::count(bench.board.executed.begin(), bench.board.executed.end(), "S,W,0,0"), 1);
    ASSERT_FALSE(bench.on("asip/uno1/servo/error").empty());
    EXPECT_EQ(json::parse(bench.on("asip/uno1/servo/error").front())["reason"], "queue-full");
}

TEST_F(OnlineBridge, LastLineNotAllowed_NoneIsSent) {
    EXPECT_EQ(bench.ask("asip/uno1/in", {{"raw", "I,d,13,1\n#,B,500000"}})["status"], "refused");
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(OnlineBridge, DamageWhileACommandIsUnderWay_IsAnsweredAsDoubt) {
    bench.board.swallow_fences = 1;
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}});
    bench.pass(2s);
    ASSERT_EQ(bench.on("answers").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("answers")[0]),
              json::parse(R"({"id":"1","status":"timeout","reason":"doubt"})"));
}

// --- who gets what

TEST_F(OnlineBridge, AnswersAndErrorsOfAClient_GoToItAlone) {
    bench.board.replies["S,W,9,9"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.client_says("#,?", 1);
    bench.client_says("S,W,9,9", 2);
    bench.client_says("#,E,mine", 3);
    bench.ask("asip/uno1/in", {{"raw", "#,N"}});
    bench.pass(1s);
    EXPECT_THAT(bench.client_lines, IsEmpty());
    ASSERT_EQ(bench.lines_for_one.size(), 3u);
    EXPECT_EQ(bench.lines_for_one[0].line.substr(0, 5), "@#,?,");
    EXPECT_EQ(bench.lines_for_one[0].client, 1u);
    EXPECT_EQ(bench.lines_for_one[1].client, 2u);
    EXPECT_EQ(bench.lines_for_one[2].line, "@#,E,mine");
    EXPECT_EQ(bench.lines_for_one[2].client, 3u);
    bench.say("@D,e,1,{42}\r\n~S,W,7{INVALID_DEVICE_NUMBER}\r\n");
    EXPECT_EQ(bench.client_lines.size(), 2u) << "events, and what nobody asked for, go to all";
}

TEST_F(OnlineBridge, ClientAsksForExtensions_IsNotOfferedThoseOfTheLine) {
    bench.client_says("#,X", 1);
    ASSERT_EQ(bench.lines_for_one.size(), 1u);
    EXPECT_EQ(bench.lines_for_one[0].line, "@#,X,2,{E:1,I:1}");
    bench.client_says("#,C,1", 1);
    ASSERT_EQ(bench.lines_for_one.size(), 2u);
    EXPECT_EQ(bench.lines_for_one[1].line, "~#,C,2{UNKNOWN_REQUEST}");
}

TEST_F(OnlineBridge, ClientTooFast_IsAskedToWaitAndLosesNothing) {
    bench.board.mute = true;
    int accepted = 0;
    while (bench.client_says("I,d,13,1", 1) == Bridge::ClientResult::kAccepted && accepted < 1000)
        ++accepted;
    EXPECT_LT(accepted, 100);
    EXPECT_EQ(bench.client_says("I,d,13,1", 1), Bridge::ClientResult::kLater);
    EXPECT_EQ(bench.client_says("I,d,13,0", 2), Bridge::ClientResult::kAccepted) << "another client";
    EXPECT_THAT(bench.on("asip/uno1/io/error"), IsEmpty());
}

TEST_F(OnlineBridge, ServiceWithoutAModel_PublishesTagAndBody) {
    bench.board.replies["#,N"] = "@#,N,2,{I:ASIP core IO,Z:A thing}";
    bench.say(bench.board.banner());
    bench.pass(1s);
    bench.say("@Z,e,2,{1,2}\r\n");
    EXPECT_THAT(bench.on("asip/uno1/Z/out"), ElementsAre(R"({"body":"2,{1,2}","tag":"e"})"));
}

TEST_F(OnlineBridge, TwoServicesOfOneKind_BothAreReached) {
    bench.board.replies["#,N"] = "@#,N,3,{I:ASIP core IO,D:Distance,S:Servos}";
    bench.say(bench.board.banner());
    bench.pass(1s);
    const session::ServiceTable table(bench.bridge.session().identity(), model::ModelSet::standard());
    EXPECT_EQ(table.find('D')->name, "distance");
    session::Identity two = bench.bridge.session().identity();
    two.services.push_back({'D', "Distance"});
    const session::ServiceTable both(two, model::ModelSet::standard());
    EXPECT_EQ(both.entries()[1].name, "distance");
    EXPECT_EQ(both.entries()[3].name, "D");
    EXPECT_NE(both.entries()[3].model, nullptr);
}

TEST_F(OnlineBridge, ResponseTopic_IsAnsweredWithTheCorrelationData) {
    mqtt::Message command;
    command.topic = "asip/uno1/servo/in";
    command.payload = R"({"write":[0,90]})";
    command.response_topic = "me";
    command.correlation = std::string("\0\xff", 2);
    bench.hear(command);
    const auto at = std::find_if(bench.published.begin(), bench.published.end(),
                                 [](const auto& p) { return p.message.topic == "me"; });
    ASSERT_NE(at, bench.published.end());
    EXPECT_EQ(at->message.correlation, command.correlation);
    EXPECT_EQ(at->priority, mqtt::Priority::kReply);
}

TEST_F(OnlineBridge, BoardNotThere_IsRefusedAndWhatWasSentTimesOut) {
    bench.board.mute = true;
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "sent");
    bench.unplug();
    EXPECT_EQ(json::parse(bench.on("answers").back())["status"], "timeout");
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "after")["reason"], "board-not-there");
}

TEST_F(OnlineBridge, QueueFull_IsRefusedAndEveryCommandIsAnsweredOnce) {
    bench.board.mute = true;
    for (int i = 0; i < 2000; ++i)
        bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}}, "n" + std::to_string(i));
    EXPECT_GE(bench.on("answers").size(), 1400u);
    EXPECT_EQ(json::parse(bench.on("answers").back())["reason"], "queue-full");
    bench.unplug();
    EXPECT_EQ(bench.on("answers").size(), 2000u);
}

TEST_F(OnlineBridge, LineOfAClient_ReachesTheBoardAndBadOnesDoNot) {
    EXPECT_EQ(bench.client_says("I,d,13,1"), Bridge::ClientResult::kAccepted);
    EXPECT_EQ(bench.client_says("#,B,500000"), Bridge::ClientResult::kRefused);
    EXPECT_EQ(bench.client_says("nonsense"), Bridge::ClientResult::kRefused);
    EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,1"));
}

// --- what fails for those who asked for no answer

struct SilentSender : OnlineBridge {
    json error(const std::string& service, std::size_t at = 0) {
        const auto errors = bench.on("asip/uno1/" + service + "/error");
        return at < errors.size() ? json::parse(errors[at]) : json();
    }
};

TEST_F(SilentSender, InvalidCommand_IsToldOnTheErrorTopicOfItsService) {
    bench.hear("asip/uno1/servo/in", R"({"write":[0,900]})");
    EXPECT_EQ(error("servo")["request"], R"({"write":[0,900]})");
    EXPECT_EQ(error("servo")["reason"], "invalid");
    EXPECT_FALSE(error("servo")["error"].get<std::string>().empty());
    bench.hear("asip/uno1/servo/in", R"({"write":[0,90)");
    EXPECT_EQ(error("servo", 1)["reason"], "invalid");
}

TEST_F(SilentSender, RawLineRefused_IsToldForTheServiceOfTheLine) {
    bench.unplug();
    bench.hear("asip/uno1/in", "S,W,0,90");
    bench.hear("asip/uno1/in", "I,d,13,1");
    bench.hear("asip/uno1/in", "T,P,440");
    EXPECT_EQ(error("servo")["request"], "W,0,90");
    EXPECT_EQ(error("servo")["reason"], "board-not-there");
    EXPECT_EQ(error("io")["request"], "d,13,1");
    EXPECT_EQ(error("T")["request"], "P,440") << "a service that the board does not have";
}

TEST_F(SilentSender, UnreadableRawText_IsToldForIoAndCutShort) {
    bench.hear("asip/uno1/in", std::string(5000, '\xff'));
    EXPECT_EQ(error("io")["reason"], "invalid");
    EXPECT_LT(bench.on("asip/uno1/io/error")[0].size(), 1000u);
}

TEST_F(SilentSender, RetainedCommand_IsToldAndClearingItIsNot) {
    bench.hear("asip/uno1/servo/in", "W,0,90", true);
    EXPECT_EQ(error("servo")["reason"], "retained");
    bench.hear("asip/uno1/servo/in", "");
    EXPECT_EQ(bench.on("asip/uno1/servo/error").size(), 1u);
}

TEST_F(SilentSender, TenThousandCommands_EachRefusalIsToldOnceAsContext) {
    bench.board.mute = true;
    for (int i = 0; i < 10'000; ++i)
        bench.hear("asip/uno1/servo/in", "W,0,90");
    const auto told = bench.published.size();
    EXPECT_GE(told, 9'400u);
    EXPECT_EQ(error("servo")["request"], "W,0,90");
    EXPECT_EQ(error("servo")["reason"], "queue-full");
    for (const auto& publication : bench.published)
        ASSERT_EQ(publication.priority, mqtt::Priority::kContext);
    bench.unplug();
    EXPECT_EQ(bench.on("asip/uno1/servo/error").size(), 10'000u) << "and those that waited, or were lost";
}

TEST_F(SilentSender, FenceLost_TimeoutIsTold) {
    bench.board.swallow_fences = 1;
    bench.hear("asip/uno1/servo/in", "W,0,90");
    bench.pass(1s);
    bench.say("@I,a,1,{0:1}\r\n");
    bench.pass(1s);
    EXPECT_EQ(error("servo")["request"], "W,0,90");
    EXPECT_EQ(error("servo")["reason"], "timeout");
}

TEST_F(SilentSender, ErrorOfTheBoard_IsToldOnce) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    bench.hear("asip/uno1/servo/in", "W,9,90");
    bench.pass(1s);
    ASSERT_EQ(bench.on("asip/uno1/servo/error").size(), 1u);
    EXPECT_EQ(error("servo")["code"], 7);
}

TEST_F(SilentSender, ReplyWanted_NothingIsOnTheErrorTopic) {
    bench.ask("asip/uno1/servo/in", {{"write", {0, 900}}});
    EXPECT_THAT(bench.on("asip/uno1/servo/error"), IsEmpty());
}

TEST_F(SilentSender, CommandExecuted_NothingIsOnTheErrorTopic) {
    bench.hear("asip/uno1/servo/in", "W,0,90");
    bench.pass(1s);
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90"));
    EXPECT_THAT(bench.on("asip/uno1/servo/error"), IsEmpty());
}

TEST_F(SilentSender, LineOfAPointToPointClientRefused_IsTold) {
    EXPECT_EQ(bench.client_says("#,B,500000"), Bridge::ClientResult::kRefused);
    EXPECT_EQ(error("io")["request"], "B,500000");
}

TEST_F(OnlineBridge, ForeignTopics_ChangeNothing) {
    for (const char* topic : {"asip/other/in", "asip/uno1/bad name/in", "x", "", "asip/uno1/io/in/more"})
        bench.hear(topic, "S,W,0,90");
    EXPECT_THAT(bench.published, IsEmpty());
}

// --- parts

TEST(ClientFraming, PlainClient_SendsAndGetsLines) {
    ClientFraming framing;
    EXPECT_THAT(framing.decode("I,d,1"), IsEmpty());
    EXPECT_THAT(framing.decode("3,1\r\n#,?\n"), ElementsAre("I,d,13,1", "#,?"));
    EXPECT_EQ(framing.encode("@I,d,4,c"), "@I,d,4,c\n");
}

TEST(ClientFraming, JavaClient_SendsAndGetsFrames) {
    ClientFraming framing;
    EXPECT_THAT(framing.decode(std::string("\0\3#,", 4)), IsEmpty());
    EXPECT_THAT(framing.decode(std::string("?\0\4I,M\n", 7)), ElementsAre("#,?", "I,M"));
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
}

TEST(Outage, FourAttemptsASecond_AreToldOnceThenOnceAMinute) {
    Outage outage;
    int told = 0;
    for (Time now{}; now < Time{} + 150s; now += 250ms)
        told += outage.failed(link::StreamError::Kind::kNotThere, now);
    EXPECT_EQ(told, 3);
}

TEST(Outage, KindsOfFailureInTurns_AreToldOnceEach) {
    Outage outage;
    int told = 0;
    for (Time now{}; now < Time{} + 30s; now += 500ms) {
        told += outage.failed(link::StreamError::Kind::kNotThere, now);
        told += outage.failed(link::StreamError::Kind::kClosed, now + 250ms);
    }
    EXPECT_EQ(told, 2);
}

TEST(Outage, BoardHeard_IsToldOnceAndTheNextOutageAtOnce) {
    Outage outage;
    EXPECT_FALSE(outage.heard()) << "there was none";
    EXPECT_TRUE(outage.failed(link::StreamError::Kind::kNotThere, Time{}));
    EXPECT_TRUE(outage.heard());
    EXPECT_FALSE(outage.heard());
    EXPECT_TRUE(outage.failed(link::StreamError::Kind::kNotThere, Time{} + 1s));
}

TEST(ClientFraming, NothingHeardYet_NothingIsSent) {
    ClientFraming framing;
    EXPECT_EQ(framing.encode("@I,d,4,c"), "");
    framing.decode(std::string("\0\3#,?", 5));
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4)) << "frames from the first one on";
}

TEST(ClientFraming, SilentClient_GetsLinesUntilItSendsAFrame) {
    ClientFraming framing;
    framing.assume_lines();
    EXPECT_EQ(framing.encode("@x"), "@x\n");
    EXPECT_THAT(framing.decode(std::string("\0\3#,?", 5)), ElementsAre("#,?"));
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
}

TEST(ClientFraming, FramingGiven_IsNotGuessed) {
    ClientFraming framing(ClientFraming::Kind::kFrames);
    EXPECT_EQ(framing.encode("@x"), std::string("\0\2@x", 4));
    EXPECT_THAT(framing.decode(std::string("\0\3#,?", 5)), ElementsAre("#,?"));
}

RecentAnswers::Key key_of(int number) {
    return RecentAnswers::key("asip/uno1/servo/in", "answers", std::to_string(number));
}

TEST(RecentAnswers, SixteenThousandAnswers_AreKeptInTwoMegabytes) {
    RecentAnswers recent;
    const int count = static_cast<int>(RecentAnswers::kGuaranteed);
    for (int i = 0; i < count; ++i) {
        recent.see(key_of(i), "p", Time{});
        recent.answer(key_of(i), bus::Reply::ok("fence"));
    }
    EXPECT_EQ(recent.dropped(), 0u);
    EXPECT_EQ(recent.see(key_of(0), "p", Time{}), RecentAnswers::Seen::kAnswered);
    EXPECT_LE(recent.bytes(), RecentAnswers::kMaxBytes);
}

TEST(RecentAnswers, LongAnswers_OldestAreDroppedAndCounted) {
    RecentAnswers recent;
    for (int i = 0; i < 10'000; ++i) {
        recent.see(key_of(i), "p", Time{});
        recent.answer(key_of(i), bus::Reply::ok("answer", std::string(1000, 'x')));
        ASSERT_LE(recent.bytes(), RecentAnswers::kMaxBytes);
    }
    EXPECT_GT(recent.dropped(), 7'000u);
    EXPECT_EQ(recent.find(key_of(0)), nullptr);
    ASSERT_NE(recent.find(key_of(9'999)), nullptr);
    EXPECT_EQ(recent.find(key_of(9'999))->answer.size(), 1000u);
}

TEST(RecentAnswers, ForgottenAndSeenAgain_IsKeptItsWholeMinute) {
    RecentAnswers recent;
    recent.see(key_of(1), "p", Time{});
    recent.forget(key_of(1));
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 30s), RecentAnswers::Seen::kNew);
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 80s), RecentAnswers::Seen::kPending);
    EXPECT_EQ(recent.see(key_of(1), "p", Time{} + 91s), RecentAnswers::Seen::kNew);
}

}  // namespace
}  // namespace asip::agent
