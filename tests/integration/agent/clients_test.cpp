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
