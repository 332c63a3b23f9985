// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// One board for all tests of this file: starting it takes longer than they do.
class AgentControl : public testing::Test {
  protected:
    AgentControl()
        : probe(broker.port()),
          agent(broker, uno.port(), {"--config", settings_file("line-terminator = lf\n")}) {
        if (!wait_state(probe, "online")) throw std::runtime_error(agent.process().errors());
    }
    json ask(const std::string& topic, const std::string& payload) {
        const auto reply = probe.request(topic, payload);
        return reply ? json::parse(*reply) : json();
    }
    bool works() { return ask("asip/uno1/io/in", R"({"write":[13,0]})")["status"] == "ok"; }

    // As the configuration that is shipped has it: the broker queues what a client cannot take yet.
    MosquittoBroker broker{{.extra_lines = {"max_queued_messages 0"}}};
    SimulatedUno uno;
    BusProbe probe;
    Agent agent;
};

TEST_F(AgentControl, CommandsInEachForm_AreExecutedAndProven) {
    EXPECT_EQ(ask("asip/uno1/io/in", R"({"mode":[13,"output"]})")["status"], "ok");
    probe.clear();
    EXPECT_EQ(ask("asip/uno1/io/in", R"({"write":{"pin":13,"level":1}})")["proof"], "fence");
    EXPECT_TRUE(probe.wait_for([](const mqtt::Message& m) {
        return m.topic == "asip/uno1/io/out" && m.payload.find(R"("12":1)") != std::string::npos;
    })) << "the wire carries it to pin 12";
    EXPECT_TRUE(probe.wait_for([](const mqtt::Message& m) {
        return m.topic == "asip/uno1/out" && m.payload.starts_with("@I,d,2,") && m.payload.back() == '\n';
    }));
    EXPECT_EQ(ask("asip/uno1/servo/in", "W,0,90")["status"], "ok");
    EXPECT_EQ(ask("asip/uno1/in", "I,d,13,0\nI,d,13,1\n")["status"], "ok");
    EXPECT_THAT(ask("asip/uno1/in", "#,?")["answer"].dump(), HasSubstr("ATmega328P"));
}

TEST_F(AgentControl, BoardRefuses_ErrorOnAnswerAndErrorTopic) {
    const auto answer = ask("asip/uno1/in", "S,W,99,90");
    EXPECT_EQ(answer["status"], "error");
    EXPECT_EQ(answer["code"], 7);
    const auto error = probe.wait_for("asip/uno1/servo/error");
    ASSERT_TRUE(error);
    EXPECT_EQ(json::parse(error->payload),
              json::parse(R"({"request":"W","code":7,"error":"INVALID_DEVICE_NUMBER"})"));
    EXPECT_TRUE(works());
}

TEST_F(AgentControl, SameIdTwice_IsExecutedOnceAndAnsweredTwice) {
    const std::string command = R"({"measure":null,"id":"m1","reply_to":"answers"})";
    probe.publish("asip/uno1/distance/in", command);
    ASSERT_TRUE(probe.wait_for("answers"));
    probe.publish("asip/uno1/distance/in", command);
    ASSERT_TRUE(wait_until([&] { return probe.count("answers") == 2; }));
    EXPECT_EQ(probe.messages("answers")[0].payload, probe.messages("answers")[1].payload);
    EXPECT_TRUE(works());
    EXPECT_LE(probe.count("asip/uno1/distance/out"), 1u);
}

TEST_F(AgentControl, GarbageOnEveryControlTopic_IsRefusedAndTheNextCommandWorks) {
    std::string deep = "{\"write\":";
    deep += std::string(5000, '[') + std::string(5000, ']') + "}";
    const std::vector<std::string> hostile{
        std::string("\0\x01\xff\xfe binary \n", 12),
        std::string(1 << 20, 'x'),
        deep,
        "{",
        "{}",
        "[]",
        "null",
        "",
        R"({"write":["a","b"]})",
        R"({"write":[1e99,1]})",
        R"({"write":[99999999999999999999,1]})",
        R"({"write":[-1,1]})",
        R"({"nonsense":[1]})",
        R"({"write":[13,1],"reply_to":"asip/+/#","id":"x"})",
        R"({"write":[13,1],"reply_to":7})",
        "#,B,300",
        "I,d,13,1\nI,d,13",
        "!!!",
        std::string(300, 'A'),
    };
    for (const char* topic :
         {"asip/uno1/io/in", "asip/uno1/in", "asip/uno1/nothing/in", "asip/uno1/distance/in"}) {
        for (const auto& payload : hostile)
            probe.publish(topic, payload);
    }
    for (const auto* payload : {R"({"write":["a","b"]})", R"({"nonsense":[1]})"}) {
        const auto answer = ask("asip/uno1/io/in", payload);
        EXPECT_EQ(answer["status"], "refused") << answer;
        EXPECT_EQ(answer["reason"], "invalid");
        EXPECT_FALSE(answer["error"].get<std::string>().empty());
    }
    for (const char* topic : {"asip/uno1/bad name/in", "asip/uno1/../in", "asip/uno1/io/in/x"})
        probe.publish(topic, "W,1");
    EXPECT_TRUE(works()) << agent.process().errors();
    EXPECT_LT(agent.process().resident_bytes(), memory_limit(40u << 20));
}

TEST_F(AgentControl, CommandThatNamesARenewalOrAPort_OvertakesNoOlderOne) {
    constexpr int kBefore = 40;
    const auto publish = [this](const json& command) {
        probe.publish("asip/uno1/io/in", command.dump());
        return command["id"].get<std::string>();
    };
    // What waits for a stopped agent comes in one piece: more than it handles at once.
    agent.process().signal(SIGSTOP);
    std::vector<std::string> sent;
    const json command{{"write", {13, 1}}, {"deadline_ms", 30'000}, {"reply_to", "answers"}};
    for (int i = 0; i < kBefore; ++i) {
        auto older = command;
        older["id"] = std::to_string(i);
        sent.push_back(publish(older));
    }
    for (const auto* word : {"renew", "port", "labels"}) {
        auto named = command;
        named["id"] = word;
        sent.push_back(publish(named));
        named["id"] = std::string("by ") + word;
        named["by"] = word;
        sent.push_back(publish(named));
    }
    agent.process().signal(SIGCONT);
    ASSERT_TRUE(wait_until([&] { return probe.count("answers") >= sent.size(); }));
    std::vector<std::string> answered;
    for (const auto& message : probe.messages("answers")) {
        const auto answer = json::parse(message.payload);
        EXPECT_EQ(answer["status"], "ok") << answer;
        answered.push_back(answer["id"]);
    }
    EXPECT_EQ(answered, sent);
}

TEST_F(AgentControl, TenThousandCommandsAtOnce_EachIsAnsweredOnce) {
    constexpr int kCommands = 10'000;
    const auto before = agent.process().resident_bytes();
    for (int i = 0; i < kCommands; ++i) {
        probe.publish("asip/uno1/io/in",
                      R"({"write":[13,)" + std::to_string(i % 2) + R"(],"id":")" + std::to_string(i) +
                          R"(","reply_to":"answers"})",
                      false, 0);
    }
    ASSERT_TRUE(wait_until([&] { return probe.count("answers") >= kCommands; }, 60s))
        << probe.count("answers") << "\n"
        << agent.process().errors().substr(0, 2000);
    std::set<std::string> ids;
    int executed = 0;
    for (const auto& message : probe.messages("answers")) {
        const auto answer = json::parse(message.payload);
        ids.insert(answer["id"].get<std::string>());
        if (answer["status"] == "ok") {
            ++executed;
        } else if (answer["status"] == "timeout") {
            continue;  // in doubt, or the agent read so many messages for longer than a command may take
        } else {
            EXPECT_EQ(answer["status"], "refused") << answer;
            EXPECT_THAT(answer["reason"].get<std::string>(), testing::AnyOf("queue-full", "deadline"));
        }
    }
    EXPECT_EQ(ids.size(), static_cast<std::size_t>(kCommands));
    EXPECT_EQ(probe.count("answers"), static_cast<std::size_t>(kCommands));
    EXPECT_GE(executed, 64);
    EXPECT_LT(agent.process().resident_bytes(), before + memory_limit(16u << 20));
    EXPECT_TRUE(works());
}

TEST(AgentRetained, RetainedCommand_IsRefusedAndNeverReplayed) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    probe.publish("asip/uno1/io/in", R"({"mode":[13,"output"],"id":"1","reply_to":"answers"})", true);
    probe.publish("asip/uno1/in", "S,W,99,90", true);
    Agent agent(broker, uno.port());
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    const auto answer = probe.wait_for("answers");
    ASSERT_TRUE(answer);
    EXPECT_EQ(json::parse(answer->payload)["reason"], "retained");
    EXPECT_TRUE(probe.request("asip/uno1/in", "#,?"));
    EXPECT_EQ(probe.count("asip/uno1/servo/error"), 0u);
}

}  // namespace
}  // namespace asip::test
