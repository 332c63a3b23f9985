// SPDX-License-Identifier: Apache-2.0
#include "asip/link/tcp_stream.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "tests/support/loop.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::link {
namespace {

using namespace std::chrono_literals;
using Kind = StreamError::Kind;
using test::run_until;
using Result = std::optional<Expected<std::unique_ptr<ByteStream>, StreamError>>;

class TcpTest : public testing::Test {
  protected:
    void listen() {
        auto opened = listen_tcp(io, {"127.0.0.1", 0},
                                 [this](std::unique_ptr<ByteStream> stream) { server = std::move(stream); });
        ASSERT_TRUE(opened) << opened.error().text;
        listener = std::move(*opened);
    }
    Result connect(const std::string& host, std::uint16_t port, Duration timeout = 5s) {
        Result result;
        const auto attempt =
            connect_tcp(io, {host, port}, timeout, [&](auto outcome) { result = std::move(outcome); });
        run_until(io, [&] { return result.has_value(); });
        return result;
    }

    boost::asio::io_context io;
    std::unique_ptr<TcpListener> listener;
    std::unique_ptr<ByteStream> server;
};

TEST_F(TcpTest, Connected_CarriesBytesBothWays) {
    listen();
    auto client = connect("localhost", listener->port());
    ASSERT_TRUE(client && *client);
    ASSERT_TRUE(run_until(io, [&] { return server != nullptr; }));
    std::string at_server, at_client;
    server->start({[&](std::string_view bytes) { at_server += bytes; }, {}});
    (**client)->start({[&](std::string_view bytes) { at_client += bytes; }, {}});
    const std::string large(1 << 20, 'x');
    (**client)->write(large);
    server->write("hello\n");
    EXPECT_TRUE(run_until(io, [&] { return at_client == "hello\n" && at_server.size() == large.size(); }));
    EXPECT_EQ(at_server, large);
}

// Two small packets, of which the second waits for the acknowledgement of the first.
TEST_F(TcpTest, PeerWithNaglesAlgorithm_IsAcknowledgedAtOnce) {
    listen();
    boost::asio::ip::tcp::socket peer(io);
    peer.connect({boost::asio::ip::address_v4::loopback(), listener->port()});
    peer.set_option(boost::asio::ip::tcp::no_delay(false));
    ASSERT_TRUE(run_until(io, [&] { return server != nullptr; }));
    std::string heard;
    server->start({[&](std::string_view bytes) { heard += bytes; }, {}});
    Duration quickest = 1h;
    for (int i = 0; i < 40; ++i) {
        heard.clear();
        const auto begin = Clock::now();
        boost::asio::write(peer, boost::asio::buffer("a", 1));
        boost::asio::write(peer, boost::asio::buffer("b", 1));
        ASSERT_TRUE(run_until(io, [&] { return heard == "ab"; }));
        if (i >= 30) quickest = std::min<Duration>(quickest, Clock::now() - begin);
        server->write("c");
        char answer = 0;
        boost::asio::read(peer, boost::asio::buffer(&answer, 1));
    }
    EXPECT_LT(quickest, 20ms);
}

TEST_F(TcpTest, PeerHangsUp_IsReported) {
    listen();
    auto client = connect("127.0.0.1", listener->port());
    ASSERT_TRUE(client && *client);
    ASSERT_TRUE(run_until(io, [&] { return server != nullptr; }));
    std::optional<StreamError> closed;
    (**client)->start({{}, [&](const StreamError& error) { closed = error; }});
    server.reset();
    ASSERT_TRUE(run_until(io, [&] { return closed.has_value(); }));
    EXPECT_EQ(closed->kind, Kind::kClosed);
}

TEST_F(TcpTest, NobodyListens_IsUnreachable) {
    auto client = connect("127.0.0.1", test::free_port());
    ASSERT_TRUE(client);
    ASSERT_FALSE(*client);
    EXPECT_EQ(client->error().kind, Kind::kUnreachable);
}

TEST_F(TcpTest, NoAnswer_EndsAtTheTimeout) {
    // A listener whose queue is full drops further SYNs, as a dead host does.
    boost::asio::io_context other;
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    ASSERT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), size), 0);
    ASSERT_EQ(::listen(fd, 0), 0);
    ASSERT_EQ(getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size), 0);
    const auto port = ntohs(address.sin_port);
    auto first = connect("127.0.0.1", port);
    auto second = connect("127.0.0.1", port, 200ms);
    auto third = connect("127.0.0.1", port, 200ms);
    ASSERT_TRUE(third);
    ASSERT_FALSE(*third);
    EXPECT_EQ(third->error().kind, Kind::kUnreachable);
    close(fd);
}

TEST_F(TcpTest, AttemptDropped_NeverCallsBack) {
    listen();
    bool called = false;
    connect_tcp(io, {"127.0.0.1", listener->port()}, 5s, [&](auto) { called = true; }).reset();
    test::run_for(io, 50ms);
    EXPECT_FALSE(called);
}

TEST_F(TcpTest, PortTaken_IsBusy) {
    listen();
    const auto second = listen_tcp(io, {"127.0.0.1", listener->port()}, [](auto) {});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, Kind::kBusy);
}

TEST(ParseTcpAddress, Forms) {
    EXPECT_EQ(parse_tcp_address("pi:5000")->host, "pi");
    EXPECT_EQ(parse_tcp_address("tcp://pi:5000")->port, 5000);
    EXPECT_EQ(parse_tcp_address("[::1]:5000")->host, "::1");
    EXPECT_EQ(parse_tcp_address("5000", "127.0.0.1")->host, "127.0.0.1");
    EXPECT_EQ(parse_tcp_address(":5000", "127.0.0.1")->port, 5000);
    for (const char* text : {"", "pi", "pi:", "pi:x", "pi:65536", ":5000", "5000"})
        EXPECT_FALSE(parse_tcp_address(text)) << text;
}

}  // namespace
}  // namespace asip::link
