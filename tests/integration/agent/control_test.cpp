// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace asip::test
