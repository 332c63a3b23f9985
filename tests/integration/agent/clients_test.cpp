// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <deque>

#include "tests/integration/agent/fake_port.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A blocking TCP client with nothing of ours in it.
class Socket {
  public:
    /// `room`: bytes that wait for it at most; 0: as many as usual.
    explicit Socket(std::uint16_t port, int room = 0) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
        if (room > 0) setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = wait_until(
            [&] { return connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0; });
    }
    ~Socket() { close(fd_); }
    bool connected() const { return connected_; }
    void send(std::string_view bytes) {
        EXPECT_EQ(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), ssize_t(bytes.size()));
    }
    /// Reads until what came contains `wanted`.
    bool receive(std::string_view wanted, std::chrono::milliseconds limit = kDeadline) {
        return wait_until(
            [&] {
                pollfd poll_for{fd_, POLLIN, 0};
                char buffer[4096];
                while (poll(&poll_for, 1, 0) > 0) {
                    const auto count = recv(fd_, buffer, sizeof buffer, 0);
                    if (count <= 0) break;
                    received.append(buffer, static_cast<std::size_t>(count));
                }
                return received.find(wanted) != std::string::npos;
            },
            limit);
    }
    /// The same behind a line that is sent again each second, where the serial port may lose bytes: what was
    /// read meanwhile is then answered with an error.
    bool ask(const std::string& line, std::string_view wanted) {
        return wait_until([&] {
            send(line + "\n");
            return receive(wanted, 1s);
        });
    }
    void end_sending() { shutdown(fd_, SHUT_WR); }
    bool closed_by_peer() {
        return wait_until([&] {
            char buffer[256];
            const auto count = recv(fd_, buffer, sizeof buffer, MSG_DONTWAIT);
            return count == 0 || (count < 0 && errno == ECONNRESET);
        });
    }
    std::string received;

  private:
    int fd_;
    bool connected_ = false;
};

/// An agent of a board that the test plays, with a port for clients.
class AgentOnPort : public testing::Test {
  protected:
    void SetUp() override { ASSERT_TRUE(wait_state(probe_, "online")) << agent_.process().errors(); }

    MosquittoBroker broker_;
    FakePort fake_;
    BusProbe probe_{broker_.port(), {"asip/servicebus/#", "asip/uno1/+/error"}};
    std::uint16_t port_ = free_port();
    Agent agent_{broker_, fake_.path(), {"--listen", std::to_string(port_)}};
};

TEST(AgentClients, PlainAndJavaClientsAtOnce_BothTalkToTheBoard) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    const auto port = free_port();
    Agent agent(broker, uno.port(), {"--listen", std::to_string(port)});
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    Socket plain(port), java(port);
    ASSERT_TRUE(plain.connected() && java.connected());
    plain.send("#,?\n");
    EXPECT_TRUE(plain.receive("@#,?,0,4,ATmega328P,20,AsipServices\n"));
    java.send(std::string("\0\3#,N", 5));
    EXPECT_TRUE(java.receive(std::string("\0", 1)));
    EXPECT_TRUE(java.receive("@#,N,3,{I:ASIP core IO,D:Distance,S:Servos}"));
    const auto at = java.received.find("@#,N");
    ASSERT_GE(at, 2u);
    EXPECT_EQ(java.received[at - 1], char(43)) << "two bytes of length before it";
    EXPECT_TRUE(probe.wait_for("asip/uno1/out", "@#,?,0,4,ATmega328P,20,AsipServices")) << "alongside MQTT";
}

TEST(AgentClients, AgentStoppedForSixSeconds_LineThatWaitedIsNotExecutedAndTheBoardIsNotBlamed) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe(broker.port());
    const auto port = free_port();
    Agent agent(broker, uno.port(), {"--listen", std::to_string(port)});
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    Socket client(port);
    client.send("I,P,12,1\nI,P,13,3\nI,d,13,0\n#,N\n");
    ASSERT_TRUE(client.receive("@#,N"));
    client.received.clear();
    probe.publish("asip/uno1/io/in", "d,13,0");  // no client wants its proof
    agent.process().signal(SIGSTOP);
    client.send("I,d,13,1\n");
    std::this_thread::sleep_for(6s);
    agent.process().signal(SIGCONT);
    EXPECT_TRUE(client.receive("~#,C,10")) << client.received;
    // More reports may have come meanwhile than a serial port keeps.
    EXPECT_TRUE(client.ask("#,E,later", "@#,E,later")) << client.received;
    EXPECT_THAT(client.received, Not(HasSubstr("@I,d"))) << "pin 12 is wired to pin 13";
    EXPECT_THAT(agent.process().errors(), Not(HasSubstr("board silent")));
    EXPECT_TRUE(client.ask("I,d,13,1", "@I,d")) << client.received;
}

/// Two clients send lines that look alike, one of them what the board refuses: whose errors go where.
TEST(AgentClients, PlainLinesOfTwoLookAlike_ErrorsGoToTheirSenderAlone) {
    for (const char* image : {"asip_uno_services", "asip_uno_04_services"}) {
        MosquittoBroker broker;
        SimulatedUno uno(image);
        BusProbe probe(broker.port());
        const auto port = free_port();
        Agent agent(broker, uno.port(), {"--listen", std::to_string(port)});
        ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
        Socket good(port), bad(port);
        for (Socket* const client : {&good, &bad}) {
            client->send("#,?\n");
            ASSERT_TRUE(client->receive("@#,?")) << image;
            client->received.clear();
        }
        for (int i = 0; i < 20; ++i) {
            good.send("I,d,13,1\n");
            bad.send("I,d,99,1\n");
            ASSERT_TRUE(bad.receive("~I,d,")) << image << ' ' << i;
            bad.received.clear();
        }
        good.send("#,?\n");
        ASSERT_TRUE(good.receive("@#,?")) << image;
        EXPECT_THAT(good.received, Not(HasSubstr("~"))) << image;
    }
}

TEST_F(AgentOnPort, ClientThatDoesNotRead_IsDroppedAndTheOthersStay) {
    Socket slow(port_);
    Socket good(port_);
    ASSERT_TRUE(slow.connected() && good.connected());
    fake_.flood("@I,a,6,{0:111,1:222,2:333,3:444,4:555,5:666}");
    bool dropped = false;
    EXPECT_TRUE(wait_until(
        [&] {
            good.received.clear();
            (void)good.receive("never", 1ms);
            dropped = dropped || agent_.process().errors().find("it does not read") != std::string::npos;
            return dropped;
        },
        40s));
    fake_.flood("");
    good.send("I,d,2,1\n");
    EXPECT_TRUE(wait_until([&] { return fake_.executed("I,d,2,1"); }));
}

// Little waits for it, so that the kernel ends the connection first.
TEST_F(AgentOnPort, ClientThatDoesNotReadTheLittleThatComes_IsLoggedAsThat) {
    constexpr int kRoom = 2048;
    Socket slow(port_, kRoom);
    Socket good(port_);
    ASSERT_TRUE(slow.connected() && good.connected());
    fake_.flood("@I,a,6,{0:111,1:222,2:333,3:444,4:555,5:666}");
    EXPECT_TRUE(wait_until([&] { return !good.receive("never", 1ms) && good.received.size() > 20'000; }));
    fake_.flood("");
    EXPECT_TRUE(wait_until(
        [&] { return agent_.process().errors().find("it does not read, or vanished") != std::string::npos; },
        30s))
        << agent_.process().errors();
    EXPECT_EQ(agent_.process().errors().find("why=closed"), std::string::npos);
}

TEST_F(AgentOnPort, SixtyFourIdleConnections_LockNobodyOutForLong) {
    constexpr std::size_t kMaxClients = 64;
    std::deque<Socket> idle;
    while (idle.size() < kMaxClients)
        ASSERT_TRUE(idle.emplace_back(port_).connected());
    Socket active(port_);  // before the others were idle for long: refused
    EXPECT_TRUE(active.closed_by_peer());
    const bool answered = wait_until(
        [&] {
            Socket late(port_);
            late.send("#,?\n");
            return late.receive("@#,?", 1s);
        },
        30s);
    EXPECT_TRUE(answered) << agent_.process().errors();
    EXPECT_TRUE(agent_.process().wait_for_errors("another wants its place"));
}

TEST_F(AgentOnPort, ThousandRefusedConnections_AreLoggedAFewTimes) {
    std::deque<Socket> kept;
    while (kept.size() < 64)
        ASSERT_TRUE(kept.emplace_back(port_).connected());
    const auto began = std::chrono::steady_clock::now();
    for (int i = 0; i < 1000; ++i) {
        if (i % 100 == 0)
            for (Socket& socket : kept)
                socket.send("#,?\n");  // they are not idle
        Socket refused(port_);
        ASSERT_TRUE(refused.connected() && refused.closed_by_peer()) << i;
    }
    const auto seconds = std::chrono::steady_clock::now() - began;
    const std::string log = agent_.process().errors();
    std::size_t lines = 0;
    for (auto at = log.find("client refused"); at != std::string::npos;
         at = log.find("client refused", at + 1))
        ++lines;
    EXPECT_GE(lines, 1u);
    EXPECT_LE(lines, 1u + static_cast<std::size_t>(seconds / 10s)) << "one in ten seconds";
}

TEST_F(AgentOnPort, JavaClientThatConnectsWhileTheBoardReports_GetsNothingButFrames) {
    Socket java(port_), silent(port_);
    ASSERT_TRUE(java.connected() && silent.connected());
    ASSERT_TRUE(agent_.process().wait_for_errors("client connected"));
    fake_.say("@I,a,1,{0:1}\r\n@I,a,1,{0:2}\r\n");
    java.send(std::string("\0\3#,N", 5));
    ASSERT_TRUE(java.receive("@#,N"));
    EXPECT_EQ(java.received[0], '\0') << "a length, not a line";
    EXPECT_TRUE(wait_until([&] {
        fake_.say("@I,a,1,{0:3}\r\n");
        return silent.receive("@I,a,1,{0:3}\n", 50ms);
    })) << "a client that stays silent gets lines after a while";
}

// The published program connects, waits 2.5 s, and then sends its first frame.
TEST(AgentClients, JavaClientThatIsSilentForLongerThanPublishedOnes_ReadsFramesOnItsPort) {
    MosquittoBroker broker;
    FakePort fake;
    BusProbe probe(broker.port(), {"asip/servicebus/#"});
    const auto other = free_port();
    Agent agent(broker, fake.path(), {"--listen", "6789," + std::to_string(other)});
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    Socket java(6789), late(other);
    ASSERT_TRUE(java.connected() && late.connected());
    std::this_thread::sleep_for(2500ms);
    fake.say("@I,a,1,{0:1}\r\n");
    late.send(std::string("\0\3#,N", 5));
    ASSERT_TRUE(late.receive("@#,N"));
    EXPECT_EQ(late.received[0], '\0') << "no line was sent to it before";
    EXPECT_TRUE(wait_until([&] {
        fake.say("@I,a,1,{0:3}\r\n");
        return java.receive("@I,a,1,{0:3}", 50ms);
    })) << "silent for good, and still served";
    EXPECT_EQ(java.received[0], '\0');
    Socket plain(6789);
    plain.send("#,?\n");
    EXPECT_TRUE(plain.receive("@#,?,0,4,")) << "lines are recognised there, too";
    EXPECT_EQ(plain.received[0], '@');
}

TEST(AgentClients, FramingGivenForAPort_IsUsedFromTheFirstByteOn) {
    MosquittoBroker broker;
    FakePort fake;
    BusProbe probe(broker.port(), {"asip/servicebus/#"});
    const auto frames = free_port(), lines = free_port();
    Agent agent(broker, fake.path(),
                {"--listen", std::to_string(frames) + "/frames", "--listen", std::to_string(lines) + "/lines",
                 "--config", settings_file("listen-silence = 1h\n")});
    ASSERT_TRUE(wait_state(probe, "online")) << agent.process().errors();
    Socket java(frames), plain(lines);
    ASSERT_TRUE(java.connected() && plain.connected());
    EXPECT_TRUE(wait_until([&] {
        fake.say("@I,a,1,{0:3}\r\n");
        return plain.receive("@I,a,1,{0:3}\n", 50ms) && java.receive("@I,a,1,{0:3}", 50ms);
    })) << agent.process().errors();
    EXPECT_EQ(java.received[0], '\0');
}

TEST_F(AgentOnPort, ClientThatEndsItsSending_GetsItsAnswersAndIsClosed) {
    Socket client(port_);
    ASSERT_TRUE(client.connected());
    std::string lines;
    for (int i = 0; i < 200; ++i)
        lines += "S,W,1," + std::to_string(i) + "\n";
    client.send(lines + "#,?\n");
    client.end_sending();
    EXPECT_TRUE(client.receive("@#,?,0,4,", 20s)) << client.received << agent_.process().errors();
    EXPECT_TRUE(fake_.executed("S,W,1,199"));
    EXPECT_TRUE(client.closed_by_peer()) << agent_.process().errors();
    Socket silent(port_);
    ASSERT_TRUE(silent.connected());
    silent.end_sending();
    EXPECT_TRUE(silent.closed_by_peer()) << "though it asked nothing";
}

TEST_F(AgentOnPort, ManyLinesAtOnce_AreReadMoreSlowlyAndNoneIsLost) {
    Socket client(port_);
    ASSERT_TRUE(client.connected());
    std::string lines;
    for (int i = 0; i < 400; ++i)
        lines += "S,W,1," + std::to_string(i) + "\n";
    client.send(lines);
    EXPECT_TRUE(wait_until([&] { return fake_.executed("S,W,1,399"); }, 20s));
    for (int i = 0; i < 400; ++i)
        ASSERT_TRUE(fake_.executed("S,W,1," + std::to_string(i))) << i;
    EXPECT_EQ(probe_.count("asip/uno1/servo/error"), 0u);
}

// Frames as the bridge of the published Java programs sends and wants them, from the port of another agent.
TEST(BoardBehindABridge, FramesAreSpokenWhereTheyAreNamedAndWhereTheyAreHeard) {
    MosquittoBroker broker;
    SimulatedUno uno;
    BusProbe probe{broker.port(), {"asip/servicebus/#", "asip/far/#"}};
    const auto bridge = "127.0.0.1:" + std::to_string(free_port());
    Agent near{broker, uno.port(), {"--listen", bridge + "/frames", "--keep-outputs"}};
    ASSERT_TRUE(wait_state(probe, "online")) << near.process().errors();
    probe.publish("asip/uno1/in", "I,A,100");
    for (const std::string framing : {"/frames", ""}) {
        ChildProcess far({ASIP_PROGRAMS "/asip-agent", "--broker", broker.url(), "--tcp", bridge + framing,
                          "--name", "far", "--keep-outputs"});
        ASSERT_TRUE(wait_state(probe, "online", kDeadline, "far")) << framing << far.errors();
        far.signal(SIGTERM);
        ASSERT_TRUE(far.wait_exit()) << framing;
        ASSERT_TRUE(wait_state(probe, "offline", kDeadline, "far"));
    }
}

}  // namespace
}  // namespace asip::test
