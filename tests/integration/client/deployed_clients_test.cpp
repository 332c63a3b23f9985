// SPDX-License-Identifier: Apache-2.0
// The clients that are deployed already, each in its own framing, written from the facts of docs/protocol.md:
// none of our client code takes part.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/integration/client/simulated_boards.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

class DeployedClients : public ::testing::Test {
  protected:
    DeployedClients() {
        EXPECT_TRUE(probe_.wait_for("asip/servicebus/uno/$state", "online")) << agent_.errors();
    }

    MosquittoBroker broker_;
    BusProbe probe_{broker_.port(), {"#"}};
    SimulatedBoards boards_{{"asip_uno_04_services"}};
    std::uint16_t port_ = free_port();
    ChildProcess agent_{{ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name", "uno", "--broker",
                         broker_.address(), "--listen", std::to_string(port_)}};
};

TEST_F(DeployedClients, MqttEvent_HasNoNewlineBecauseJavaParsesItsTailAsHexadecimal) {
    probe_.publish("asip/uno/in", "I,P,2,2");
    const auto event = probe_.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/uno/out" && message.payload.starts_with("@I,d");
    });
    ASSERT_TRUE(event);
    const auto mask = event->payload.substr(event->payload.rfind(',') + 1);
    EXPECT_EQ(mask.find_first_not_of("0123456789abcdefABCDEF"), std::string::npos) << event->payload;
}

/// What python-asip's newer class for MQTT does: publishes requests on `/out`, collects what comes on `/in`
/// and cuts it at newlines, asks for the port map until it has it.
class NewerPythonClient {
  public:
    explicit NewerPythonClient(std::uint16_t port) : probe_(port, {"asip/uno/in"}, {.v5 = false}) {}

    void write(const std::string& request) { probe_.publish("asip/uno/out", request + "\n", false, 0); }
    bool has_line(const std::string& begin) const {
        std::string all;
        for (const auto& message : probe_.messages())
            all += message.payload;
        std::istringstream lines(all.substr(0, all.rfind('\n') + 1));
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with(begin)) return true;
        return false;
    }
    bool ask_for_port_map() {
        return wait_until([&] {
            write("I,M");
            return wait_until([&] { return has_line("@I,M,20"); }, 500ms);
        });
    }

  private:
    BusProbe probe_;
};

class ClientSideTopics : public ::testing::Test {
  protected:
    ClientSideTopics() {
        EXPECT_TRUE(probe_.wait_for("asip/servicebus/uno/$state", "online")) << agent_.errors();
    }
    Finished asipctl(std::vector<std::string> words) {
        words.insert(words.begin(), {ASIP_TEST_ASIPCTL, "--broker", broker_.address()});
        return run(words);
    }

    MosquittoBroker broker_;
    BusProbe probe_{broker_.port(), {"#"}};
    SimulatedBoards boards_{{"asip_uno_04_services"}};
    ChildProcess agent_{{ASIP_TEST_AGENT, "--serial", boards_.serial(), "--name", "uno", "--broker",
                         broker_.address(), "--config", settings_file("topics = client-side\n")}};
};

TEST_F(ClientSideTopics, NewerPythonClient_SeesTheButtonAndSwitchesTheLed) {
    NewerPythonClient client(broker_.port());
    ASSERT_TRUE(client.ask_for_port_map());
    client.write("I,A,0");
    client.write("I,P,2,2");
    EXPECT_TRUE(wait_until([&] { return client.has_line("@I,d,4,"); }));
    client.write("I,P,13,3");
    client.write("I,d,13,1");
    EXPECT_TRUE(boards_.wait_for_led("on")) << agent_.errors();
    boards_.press();
    EXPECT_TRUE(wait_until([&] { return client.has_line("@I,d,4,0"); }));
    for (const auto& message : probe_.messages("asip/uno/out"))
        EXPECT_FALSE(message.payload.starts_with("@")) << message.payload;
}

TEST_F(ClientSideTopics, ProgramsOfOurs_WorkAsWithAnyBoard) {
    EXPECT_EQ(asipctl({"pin", "uno", "13", "high"}).status, 0);
    EXPECT_TRUE(boards_.wait_for_led("on"));
    EXPECT_EQ(asipctl({"send", "uno", "--raw", "I,d,13,0"}).status, 0);
    EXPECT_TRUE(boards_.wait_for_led("off"));
    EXPECT_EQ(asipctl({"ping", "uno", "-n", "2"}).status, 0);
    ChildProcess registry({ASIP_TEST_REGISTRY, "--broker", broker_.address()});
    ASSERT_TRUE(probe_.wait_for([](const mqtt::Message& message) {
        return message.topic.starts_with("asip/registry/") && message.payload == "online";
    }));
    const auto listed = asipctl({"list"});
    EXPECT_NE(listed.output.find("online"), std::string::npos) << listed.output << listed.errors;
}

}  // namespace
}  // namespace asip::test
