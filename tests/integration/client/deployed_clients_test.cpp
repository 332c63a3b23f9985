// SPDX-License-Identifier: Apache-2.0
// The clients that are deployed already, each in its own framing, written from the facts of docs/protocol.md:
// none of our client code takes part.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <sstream>

#include "tests/integration/client/simulated_boards.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

using ::testing::StartsWith;

/// A blocking TCP client, as an application of the time has it.
class PlainSocket {
  public:
    explicit PlainSocket(std::uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    }
    ~PlainSocket() { close(fd_); }
    PlainSocket(const PlainSocket&) = delete;
    PlainSocket& operator=(const PlainSocket&) = delete;

    bool connected() const { return connected_; }
    void send(const std::string& bytes) {
        ASSERT_EQ(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
    }
    /// The next `count` bytes; fewer when they do not come in time.
    std::string read(std::size_t count) {
        while (buffer_.size() < count && more()) {
        }
        return take(std::min(count, buffer_.size()));
    }
    /// The next line without its newline; empty when none comes in time.
    std::string read_line() {
        while (buffer_.find('\n') == std::string::npos && more()) {
        }
        const auto end = buffer_.find('\n');
        if (end == std::string::npos) return {};
        std::string line = take(end + 1);
        line.pop_back();
        return line;
    }

  private:
    bool more() {
        pollfd waiting{fd_, POLLIN, 0};
        if (poll(&waiting, 1, static_cast<int>(kDeadline.count())) <= 0) return false;
        char bytes[4096];
        const auto count = recv(fd_, bytes, sizeof bytes, 0);
        if (count > 0) buffer_.append(bytes, static_cast<std::size_t>(count));
        return count > 0;
    }
    std::string take(std::size_t count) {
        std::string taken = buffer_.substr(0, count);
        buffer_.erase(0, count);
        return taken;
    }

    int fd_;
    bool connected_ = false;
    std::string buffer_;
};

/// What Java's DataOutput.writeUTF puts on the wire for ASCII text.
std::string write_utf(const std::string& text) {
    return std::string{static_cast<char>(text.size() >> 8), static_cast<char>(text.size() & 0xff)} + text;
}

/// DataInput.readUTF.
std::string read_utf(PlainSocket& socket) {
    const std::string length = socket.read(2);
    if (length.size() < 2) return {};
    return socket.read(static_cast<std::size_t>(static_cast<unsigned char>(length[0]) << 8 |
                                                static_cast<unsigned char>(length[1])));
}

template <class Read>
std::string read_until(Read read, const std::string& prefix) {
    for (int i = 0; i < 1000; ++i) {
        std::string line = read();
        if (line.empty() || line.starts_with(prefix)) return line;
    }
    return "never came";
}

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

TEST_F(DeployedClients, PlainLinesOverTcp_AreAnsweredInLines) {
    PlainSocket client(port_);
    ASSERT_TRUE(client.connected());
    client.send("#,?\n");
    EXPECT_THAT(read_until([&] { return client.read_line(); }, "@#,?"),
                StartsWith("@#,?,0,4,ATmega328P,20,"));
    client.send("I,P,13,3\r\nI,d,13,1\r\n");
    EXPECT_TRUE(boards_.wait_for_led("on"));
}

TEST_F(DeployedClients, JavaFramesOverTcp_AreAnsweredInFrames) {
    PlainSocket client(port_);
    ASSERT_TRUE(client.connected());
    client.send(write_utf("#,?\n"));
    const std::string answer = read_until([&] { return read_utf(client); }, "@#,?");
    EXPECT_THAT(answer, StartsWith("@#,?,0,4,ATmega328P,20,"));
    client.send(write_utf("I,P,13,3\n") + write_utf("I,d,13,1"));
    EXPECT_TRUE(boards_.wait_for_led("on")) << "with newline and without";
}

TEST_F(DeployedClients, ManyClientsAtOnce_EachHearsTheBoardInItsOwnFraming) {
    PlainSocket python(port_);
    PlainSocket java(port_);
    ASSERT_TRUE(python.connected() && java.connected());
    java.send(write_utf("I,P,2,2\n"));
    python.send("#,?\n");
    EXPECT_THAT(read_until([&] { return python.read_line(); }, "@I,d"), StartsWith("@I,d,"));
    EXPECT_THAT(read_until([&] { return read_utf(java); }, "@I,d"), StartsWith("@I,d,"));
}

TEST_F(DeployedClients, FrameCutInPieces_IsPutTogether) {
    PlainSocket client(port_);
    ASSERT_TRUE(client.connected());
    for (const char byte : write_utf("I,P,13,3\n") + write_utf("I,d,13,1\n"))
        client.send(std::string(1, byte));
    EXPECT_TRUE(boards_.wait_for_led("on"));
}

TEST_F(DeployedClients, MqttRequest_WorksWithNewlineAndWithout) {
    probe_.publish("asip/uno/in", "I,P,13,3\n");
    probe_.publish("asip/uno/in", "I,d,13,1");
    EXPECT_TRUE(boards_.wait_for_led("on"));
    probe_.publish("asip/uno/in", "I,d,13,0\r\n");
    EXPECT_TRUE(boards_.wait_for_led("off"));
}

TEST_F(DeployedClients, MqttEvent_HasNoNewlineBecauseJavaParsesItsTailAsHexadecimal) {
    probe_.publish("asip/uno/in", "I,P,2,2");
    const auto event = probe_.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/uno/out" && message.payload.starts_with("@I,d");
    });
    ASSERT_TRUE(event);
    const auto mask = event->payload.substr(event->payload.rfind(',') + 1);
    EXPECT_EQ(mask.find_first_not_of("0123456789abcdefABCDEF"), std::string::npos) << event->payload;
}

TEST_F(DeployedClients, AnalogEvents_ComeOneToAMessage) {
    probe_.publish("asip/uno/in", "I,A,20");
    const auto event = probe_.wait_for([](const mqtt::Message& message) {
        return message.topic == "asip/uno/out" && message.payload.starts_with("@I,a");
    });
    ASSERT_TRUE(event);
    EXPECT_EQ(event->payload.find('@', 1), std::string::npos) << event->payload;
    EXPECT_EQ(event->payload.back(), '}');
}

TEST(DeployedClientsWithNewline, PythonOverMqtt_GetsItWhereTheAgentIsConfiguredTo) {
    const MosquittoBroker broker;
    BusProbe probe(broker.port(), {"asip/uno/out", "asip/servicebus/#"});
    SimulatedBoards boards({"asip_uno_04"});
    ChildProcess agent({ASIP_TEST_AGENT, "--serial", boards.serial(), "--name", "uno", "--broker",
                        broker.address(), "--config", settings_file("line-terminator = lf\n")});
    ASSERT_TRUE(probe.wait_for("asip/servicebus/uno/$state", "online")) << agent.errors();
    probe.publish("asip/uno/in", "I,A,20\n");
    const auto event =
        probe.wait_for([](const mqtt::Message& message) { return message.payload.starts_with("@I,a"); });
    ASSERT_TRUE(event);
    EXPECT_EQ(event->payload.back(), '\n');
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

TEST_F(ClientSideTopics, RequestOnIn_IsNotExecuted) {
    probe_.publish("asip/uno/in", "I,P,13,3\nI,d,13,1");
    probe_.publish("asip/uno/out", "#,?");
    EXPECT_TRUE(
        probe_.wait_for([](const mqtt::Message& message) { return message.payload.starts_with("@#,?"); }));
    EXPECT_EQ(boards_.led_changes("on"), 0);
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
