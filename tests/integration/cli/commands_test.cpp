// SPDX-License-Identifier: Apache-2.0
// Commands and their answers, against a scripted agent.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/tcp_relay.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SendTest : public BusTest {
  protected:
    void SetUp() override { announce("uno1"); }

    /// Runs asipctl, answers its first command with `reply` and returns how it ended.
    Finished answered(const Words& arguments, const std::string& topic, const std::string& reply) {
        ChildProcess child(program(arguments), environment());
        request_ = probe_.wait_for(topic);
        if (!request_) return {-1, child.output(), child.errors()};
        answer(*request_, reply);
        const auto status = child.wait_exit().value_or(-1);
        return {status, child.output(), child.errors()};
    }

    std::optional<mqtt::Message> request_;
};

TEST_F(SendTest, Acknowledged_PrintsOkAndEndsWith0) {
    const auto sent = answered({"send", "uno1/servo", "write", "0", "90"}, "asip/uno1/servo/in",
                               R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(sent.status, 0) << sent.errors;
    EXPECT_EQ(sent.output, "ok\n");
    const auto payload = nlohmann::json::parse(request_->payload);
    EXPECT_EQ(payload["raw"], "W,0,90");
    EXPECT_EQ(payload["reply_to"], request_->response_topic) << "a bridge may drop the properties";
    EXPECT_EQ(payload["id"], request_->correlation);
    EXPECT_EQ(payload["deadline_ms"], 5000);
    EXPECT_THAT(request_->expiry_seconds,
                testing::Optional(testing::AllOf(testing::Ge(3u), testing::Le(5u))));
    EXPECT_FALSE(request_->retain);
    EXPECT_THAT(request_->response_topic, testing::StartsWith("asip/reply/"));
    EXPECT_FALSE(request_->correlation.empty());
}

TEST_F(SendTest, BoardsError_EndsWith1AndItsWords) {
    const auto sent = answered({"send", "uno1/servo", "write", "7", "90"}, "asip/uno1/servo/in",
                               R"({"status":"error","code":7,"error":"INVALID_DEVICE_NUMBER"})");
    EXPECT_EQ(sent.status, 1);
    EXPECT_THAT(sent.output, IsEmpty());
    EXPECT_THAT(sent.errors, HasSubstr("S,W,7,90: the board refused it: INVALID_DEVICE_NUMBER (error 7)"));
}

TEST_F(SendTest, NobodyAnswers_EndsWith4InTime) {
    const auto sent = asipctl({"send", "uno1/servo", "write", "0", "90", "--timeout", "300ms"});
    EXPECT_EQ(sent.status, 4);
    EXPECT_THAT(sent.errors, HasSubstr("within 300 ms; it may or may not have been executed"));
}

TEST_F(SendTest, BrokerThatMeetsMqtt5WithSilence_IsUsedWith311InOneCall) {
    const TcpRelay silent(broker_.port(), [](std::string_view first) {
        constexpr std::size_t kVersion = 8;  // CONNECT: type, length, 0 4 M Q T T, version
        return first.size() > kVersion && first[kVersion] == 5;
    });
    ChildProcess sending(program({"send", "uno1/servo", "write", "0", "90", "--broker",
                                  "127.0.0.1:" + std::to_string(silent.port())}),
                         environment());
    const auto request = probe_.wait_for("asip/uno1/servo/in");
    ASSERT_TRUE(request) << sending.errors();
    const auto document = nlohmann::json::parse(request->payload);
    nlohmann::json reply{{"id", document["id"]}, {"status", "ok"}, {"proof", "fence"}};
    probe_.publish(document["reply_to"].get<std::string>(), reply.dump());
    EXPECT_EQ(sending.wait_exit(), 0) << sending.errors();
    EXPECT_EQ(sending.output(), "ok\n");
}

TEST_F(SendTest, OutOfRange_NeverReachesTheBus) {
    const auto sent = asipctl({"send", "uno1/servo", "write", "0", "181"});
    EXPECT_EQ(sent.status, 2);
    EXPECT_THAT(sent.errors, HasSubstr("angle: 181 is above 180"));
    EXPECT_THAT(asipctl({"send", "uno1/servo", "write", "0", "-5"}).errors,
                HasSubstr("angle: -5 is below 0"));
    probe_.publish("asip/sentinel", "1");
    ASSERT_TRUE(probe_.wait_for("asip/sentinel"));
    EXPECT_EQ(probe_.count("asip/uno1/servo/in"), 0U);
}

TEST_F(SendTest, BoardThatSaidGoodbye_IsReportedAtOnce) {
    announce("uno1", "offline");
    const auto sent = asipctl({"send", "uno1/servo", "write", "0", "90"});
    EXPECT_EQ(sent.status, 1);
    EXPECT_THAT(sent.errors, HasSubstr("offline"));
}

TEST_F(SendTest, RawLine_GoesToTheBoardAndItsAnswerIsPrinted) {
    const auto sent =
        answered({"send", "uno1", "--raw", "#,?"}, "asip/uno1/in",
                 R"({"status":"ok","proof":"answer","answer":"@#,?,0,4,ATmega328P,20,AsipHello"})");
    EXPECT_EQ(sent.status, 0);
    EXPECT_EQ(sent.output, "@#,?,0,4,ATmega328P,20,AsipHello\n");
}

TEST_F(SendTest, StandardInput_SendsAllAndEndsWithTheFirstFailure) {
    ChildProcess child(program({"send", "--stdin"}), environment());
    child.write_input(
        "# a comment\n  \t# an indented one\nuno1/servo write 0 10\nuno1/servo write 0 999\nuno1/servo write "
        "0 20\n");
    child.close_input();
    for (const auto* payload : {"W,0,10", "W,0,20"}) {
        const auto request = probe_.wait_for([&](const mqtt::Message& message) {
            return message.topic == "asip/uno1/servo/in" &&
                   message.payload.find(payload) != std::string::npos;
        });
        ASSERT_TRUE(request) << payload;
        answer(*request, R"({"status":"ok","proof":"fence"})");
    }
    EXPECT_EQ(child.wait_exit(), 2);
    EXPECT_EQ(child.output(), "ok\nok\n");
    EXPECT_THAT(child.errors(), HasSubstr("line 4: uno1/servo: angle: 999 is above 180"));
}

TEST_F(SendTest, StandardInputSavedByAnEditorOfWindows_IsReadAsItIsMeant) {
    ChildProcess child(program({"send", "--stdin"}), environment());
    child.write_input("\xef\xbb\xbfuno1/servo write 0 10\r\n\r\n# a comment\r\nuno1/servo write 0 20\r\n");
    child.close_input();
    for (const auto* payload : {"W,0,10\"", "W,0,20\""}) {
        const auto request = probe_.wait_for([&](const mqtt::Message& message) {
            return message.topic == "asip/uno1/servo/in" &&
                   message.payload.find(payload) != std::string::npos;
        });
        ASSERT_TRUE(request) << payload << child.errors();
        answer(*request, R"({"status":"ok","proof":"fence"})");
    }
    EXPECT_EQ(child.wait_exit(), 0) << child.errors();
    ChildProcess utf16(program({"send", "--stdin"}), environment());
    utf16.write_input(std::string("\xff\xfeu\0n\0o\0", 8));
    utf16.close_input();
    EXPECT_EQ(utf16.wait_exit(), 2);
    EXPECT_THAT(utf16.errors(), HasSubstr("save them as UTF-8"));
}

TEST_F(SendTest, PingABoard_MeasuresItsAnswersAndCountsLosses) {
    ChildProcess child(program({"ping", "uno1", "-c", "2", "-i", "0", "--timeout", "400ms"}), environment());
    const auto first = probe_.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/uno1/in" && message.payload.find("#,E,p1") != std::string::npos;
    });
    ASSERT_TRUE(first);
    answer(*first, R"({"status":"ok","proof":"fence"})");
    EXPECT_EQ(child.wait_exit(), 0);
    EXPECT_THAT(child.output(), HasSubstr("uno1: seq=1 time="));
    EXPECT_THAT(child.output(), HasSubstr("uno1: seq=2 no answer within 400 ms"));
    EXPECT_THAT(child.output(), HasSubstr("2 sent, 1 answered, 50 % lost"));
}

TEST_F(SendTest, PingWithoutATerminal_EndsAfterFive) {
    const auto ping = asipctl({"ping", "uno1", "-i", "0", "--timeout", "50ms"});
    EXPECT_EQ(ping.status, 4);
    EXPECT_THAT(ping.output, HasSubstr("5 sent, 0 answered"));
}

TEST_F(SendTest, ModelThatOnlyABoardCarries_IsExplained) {
    probe_.publish("asip/servicebus/uno9/$description",
                   R"({"board":"uno9","session":"s1","seq":1,"services":[{"name":"thermo","id":"W","model":
                      {"name":"thermo","version":1,"id":"W","match":["Thermo"],"title":"A thermometer",
                       "events":{"t":{"name":"celsius","title":"How warm","shape":"plain",
                                      "fields":[{"name":"celsius","type":"integer","unit":"C"}]}}}}]})",
                   true);
    ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    const auto explained = asipctl({"model", "thermo"});
    EXPECT_EQ(explained.status, 0) << explained.errors;
    EXPECT_THAT(explained.output, HasSubstr("How warm"));
    const auto unknown = asipctl({"model", "nothing"});
    EXPECT_EQ(unknown.status, 1);
    EXPECT_THAT(unknown.errors, HasSubstr("no board on the bus brings one"));
}

TEST_F(SendTest, LabelsOfWhoKeepsNone_IsNoSuccess) {
    announce("uno1");
    ChildProcess label(program({"label", "uno1", "room=lab", "--from-bus"}), environment());
    const auto request = probe_.wait_for("asip/uno1/in");
    ASSERT_TRUE(request) << label.errors();
    answer(*request, R"({"status":"ok","proof":"simulated"})");
    EXPECT_EQ(label.wait_exit(), 1);
    EXPECT_THAT(label.errors(), HasSubstr("keeps no labels"));
}

TEST_F(SendTest, NothingAsked_PrintsTheHelp) {
    const auto alone = asipctl({});
    EXPECT_EQ(alone.status, 0) << alone.errors;
    EXPECT_THAT(alone.output, HasSubstr("Usage: asipctl"));
    EXPECT_EQ(alone.output, asipctl({"--help"}).output);
}

TEST_F(SendTest, DutyBehindPwm_IsTheDuty) {
    announce("uno1");
    const auto wrong = asipctl({"pin", "uno1", "3", "high", "7", "--from-bus"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.errors, HasSubstr("behind pwm"));
    ChildProcess pin(program({"pin", "uno1", "3", "pwm", "128", "--from-bus"}), environment());
    std::size_t answered = 0;
    EXPECT_TRUE(wait_until([&] {
        const auto asked = probe_.messages("asip/uno1/io/in");
        for (; answered < asked.size(); ++answered)
            answer(asked[answered], asked[answered].payload.find("a,3") == std::string::npos &&
                                            asked[answered].payload.find("P,3") == std::string::npos
                                        ? R"({"status":"ok","proof":"answer","answer":{"modes":[6,6,1,1]}})"
                                        : R"({"status":"ok","proof":"fence"})");
        return !pin.running();
    })) << pin.errors();
    EXPECT_EQ(pin.wait_exit(), 0) << pin.errors();
    EXPECT_THAT(pin.output(), HasSubstr("3 pwm")) << pin.errors();
    const auto sent = probe_.messages("asip/uno1/io/in");
    EXPECT_TRUE(std::any_of(sent.begin(), sent.end(), [](const auto& each) {
        return each.payload.find("a,3,128") != std::string::npos;
    }));
}

}  // namespace
}  // namespace asip::test
