// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

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

TEST_F(OnlineBridge, AnswerThatTheModelCannotRead_IsDoubt) {
    int id = 0;
    for (const char* damaged : {"@D,e,{0:0,1:0}", "@D,e,2,{42}", "@D,e,2,{42,1x8}"}) {
        bench.board.replies["D,M"] = damaged;
        EXPECT_EQ(bench.ask("asip/uno1/distance/in", {{"measure", nullptr}}, std::to_string(++id))["reason"],
                  "doubt")
            << damaged;
    }
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

TEST_F(OnlineBridge, ListOfCommands_IsOneCommandWithTheAnswersOfAll) {
    bench.board.replies["D,M"] = "@D,e,2,{42,118}";
    EXPECT_EQ(
        bench.ask("asip/uno1/servo/in", json::parse(R"({"commands":[{"write":[0,1]},{"write":[0,2]}]})")),
        json::parse(R"({"id":"1","status":"ok","proof":"fence"})"));
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,1", "S,W,0,2"));
    EXPECT_EQ(bench.ask("asip/uno1/distance/in",
                        json::parse(R"({"commands":[{"measure":null},{"measure":null}]})"), "2")["answer"],
              json::parse(R"([{"distance":[42,118]},{"distance":[42,118]}])"));
}

TEST_F(OnlineBridge, ListOfCommandsWithABadOne_IsRefusedWholeAndSaysWhich) {
    int id = 0;
    const auto ask = [&](const std::string& list) {
        return bench.ask("asip/uno1/servo/in", json::parse(R"({"commands":)" + list + "}"),
                         "b" + std::to_string(++id));
    };
    EXPECT_EQ(ask(R"([{"write":[0,1]},{"wirte":[0,2]}])")["error"],
              "commands: number 2: no command 'wirte'; did you mean 'write'?");
    for (const char* list :
         {"[]", "7", "{}", R"([{"write":[0,1]},7])", R"([{"commands":[{"write":[0,1]}]}])"})
        EXPECT_EQ(ask(list)["reason"], "invalid") << list;
    json many = json::array();
    for (int i = 0; i < 65; ++i)
        many.push_back({{"write", {0, 1}}});
    EXPECT_EQ(ask(many.dump())["error"], "commands: is not a list of 1 to 64 commands");
    EXPECT_THAT(bench.board.executed, IsEmpty());
    many.erase(0);
    EXPECT_EQ(ask(many.dump())["status"], "ok");
    EXPECT_EQ(bench.board.executed.size(), 64u);
}

TEST_F(OnlineBridge, ListOfCommandsWithOneThatTheBoardRefuses_IsItsError) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    EXPECT_EQ(
        bench.ask("asip/uno1/servo/in",
                  json::parse(R"({"commands":[{"write":[0,1]},{"write":[9,90]},{"write":[0,2]}]})"))["code"],
        7);
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

TEST_F(OnlineBridge, RequestThatIsNoJson_IsRefusedWhereItsAnswerIsWanted) {
    bench.hear("asip/uno1/io/in", R"({"write":[13,1],"deadline_ms":1e400,"id":"7","reply_to":"answers"})");
    mqtt::Message message{.topic = "asip/uno1/io/in",
                          .payload = "{\"write\":\"\xff\"",
                          .response_topic = "answers",
                          .correlation = "c"};
    bench.hear(message);
    const auto answers = bench.on("answers");
    ASSERT_EQ(answers.size(), 2u);
    EXPECT_EQ(json::parse(answers[0]), json::parse(R"({"status":"refused","reason":"invalid","id":"7",
        "error":"a number in the request is too large"})"));
    EXPECT_EQ(json::parse(answers[1])["reason"], "invalid");
    EXPECT_EQ(bench.published.back().message.correlation, "c");
    EXPECT_THAT(bench.on("asip/uno1/io/error"), IsEmpty());
    EXPECT_THAT(bench.board.executed, IsEmpty());
}

TEST_F(OnlineBridge, ServiceTheBoardDoesNotHave_IsRefused) {
    EXPECT_EQ(bench.ask("asip/uno1/tone/in", {{"play", {440, 100}}})["status"], "refused");
}

TEST_F(OnlineBridge, TextAndRawLines_AreExecuted) {
    bench.hear("asip/uno1/servo/in", "W,0,90");
    bench.hear("asip/uno1/in", "I,d,13,1\nI,d,13,0\r\n");
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90", "I,d,13,1", "I,d,13,0"));
}

TEST_F(OnlineBridge, EachPayload_IsExecutedOrReportedWhateverItHolds) {
    for (const char* end : {"", "\n", "\r", "\r\n", "\n\r"})
        for (const std::string& before : {std::string(), std::string("  "), std::string("\0\t\x1b", 3)}) {
            bench.board.executed.clear();
            bench.hear("asip/uno1/in", before + "I,d,13,1" + end);
            bench.hear("asip/uno1/in", before + "I,d,13,0\r" + before + "I,d,13,1" + end);
            bench.hear("asip/uno1/servo/in", before + "W,0,90" + end);
            EXPECT_THAT(bench.board.executed, ElementsAre("I,d,13,1", "I,d,13,0", "I,d,13,1", "S,W,0,90"));
        }
    EXPECT_THAT(bench.on("asip/uno1/io/error"), IsEmpty());
    bench.board.executed.clear();
    for (const std::string& bad :
         {std::string("a\rb"), std::string("\r"), std::string(1, '\0'), std::string(" "),
          std::string("!hello"), std::string("x"), std::string("I,\0d", 4), std::string("\xff"),
          std::string("I,d,13,1\rI")}) {
        const auto errors = bench.on("asip/uno1/io/error").size();
        bench.hear("asip/uno1/in", bad);
        EXPECT_EQ(bench.on("asip/uno1/io/error").size(), errors + 1) << bad;
    }
    EXPECT_THAT(bench.board.executed, IsEmpty());
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

TEST_F(OnlineBridge, BoardMute_EachCommandIsAnsweredAtItsDeadline) {
    bench.board.mute = true;
    bench.hear("asip/uno1/servo/in", R"({"write":[0,90],"id":"1","reply_to":"answers","deadline_ms":200})");
    bench.hear("asip/uno1/servo/in", R"({"write":[0,91],"id":"2","reply_to":"answers","deadline_ms":200})");
    bench.pass(200ms);
    EXPECT_EQ(bench.on("answers").size(), 2u);
    bench.hear(mqtt::Message{.topic = "asip/uno1/servo/in",
                             .payload = R"({"write":[0,92],"id":"3","reply_to":"answers"})",
                             .expiry_seconds = 1});
    bench.pass(1s);
    EXPECT_EQ(bench.on("answers").size(), 3u);
}

TEST_F(OnlineBridge, LongOnItsWay_TheRestOfItsExpiryBoundsTheDeadline) {
    bench.board.mute = true;
    bench.hear(
        mqtt::Message{.topic = "asip/uno1/servo/in",
                      .payload = R"({"write":[0,92],"id":"3","reply_to":"answers","deadline_ms":5000})",
                      .expiry_seconds = 1});
    bench.pass(1900ms);
    EXPECT_EQ(bench.on("answers").size(), 0u) << "a broker cuts off up to a second";
    bench.pass(100ms);
    EXPECT_EQ(bench.on("answers").size(), 1u);
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

TEST_F(OnlineBridge, SomeLinesNotSentAndOneWithAnError_IsCalledPartly) {
    bench.board.replies["S,W,9,90"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
    std::string lines = "S,W,9,90";
    for (int i = 0; i < 20; ++i)
        lines += "\nS,W,0," + std::to_string(100 + i);
    bench.board.swallow_fences = 3;
    bench.ask("asip/uno1/in", {{"raw", lines}});
    bench.board.mute = true;
    bench.pass(10s);
    ASSERT_EQ(bench.on("answers").size(), 1u);
    const auto answer = json::parse(bench.on("answers")[0]);
    EXPECT_EQ(answer["status"], "timeout") << answer;
    EXPECT_EQ(answer["reason"], "partly") << answer;
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

TEST_F(OnlineBridge, GoodbyeWhileTheEffectsOfALineAreCarriedOut_EachCommandIsAnsweredOnce) {
    bench.board.mute = true;
    for (int i = 0; i < 5; ++i)
        bench.hear("asip/uno1/servo/in", json{{"write", {0, i}}, {"id", i}, {"reply_to", "answers"}}.dump());
    Effects of_line, of_goodbye;
    bench.bridge.receive("~S,W,7{INVALID_DEVICE_NUMBER}\r\n!Script running on X with Services: I S \r\n",
                         bench.now, of_line);
    bench.bridge.goodbye(bench.now, of_goodbye);
    std::map<std::string, int> answers;
    for (const auto* effects : {&of_line, &of_goodbye})
        for (const auto& publication : effects->publish)
            if (publication.message.topic == "answers")
                ++answers[json::parse(publication.message.payload)["id"].dump()];
    EXPECT_EQ(answers.size(), 5u);
    for (const auto& [id, times] : answers)
        EXPECT_EQ(times, 1) << id;
}

TEST_F(OnlineBridge, DamageWhileACommandIsUnderWay_IsAnsweredAsDoubt) {
    bench.board.swallow_fences = 1;
    bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}});
    bench.pass(2s);
    ASSERT_EQ(bench.on("answers").size(), 1u);
    EXPECT_EQ(json::parse(bench.on("answers")[0]),
              json::parse(R"({"id":"1","status":"timeout","reason":"doubt"})"));
}

}  // namespace
}  // namespace asip::agent
