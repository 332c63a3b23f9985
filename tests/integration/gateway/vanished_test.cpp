// SPDX-License-Identifier: Apache-2.0
// Clients that are gone: what the gateway keeps of them, and for how long.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <filesystem>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class GatewayVanished : public GatewayTest {
  protected:
    /// A copy of the gateway's end of a connection from `port`; -1: this system gives none.
    int its_end_of(std::uint16_t client_port) {
        const auto pid = gateway_.process().pid();
        const int process = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
        if (process < 0) return -1;
        int found = -1;
        for (const auto& entry :
             std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd")) {
            const int copy = static_cast<int>(
                syscall(SYS_pidfd_getfd, process, std::stoi(entry.path().filename().string()), 0));
            sockaddr_in peer{};
            socklen_t size = sizeof peer;
            if (copy >= 0 && getpeername(copy, reinterpret_cast<sockaddr*>(&peer), &size) == 0 &&
                peer.sin_family == AF_INET && ntohs(peer.sin_port) == client_port) {
                found = copy;
                break;
            }
            if (copy >= 0) close(copy);
        }
        close(process);
        return found;
    }
    static int option(int socket, int name) {
        int value = -1;
        socklen_t size = sizeof value;
        getsockopt(socket, IPPROTO_TCP, name, &value, &size);
        return value;
    }
};

/// The kernel takes a client that answers nothing for alive for a quarter of an hour, or, where nothing is
/// sent, for two hours.
TEST_F(GatewayVanished, ClientThatAnswersNothing_IsGoneWithinAMinute) {
    Wire client(port());
    client.send("GET /api/events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    ASSERT_THAT(client.read_until("\r\n\r\n"), HasSubstr("200"));
    sockaddr_in own{};
    socklen_t size = sizeof own;
    ASSERT_EQ(getsockname(client.socket(), reinterpret_cast<sockaddr*>(&own), &size), 0);
    const int its_end = its_end_of(ntohs(own.sin_port));
    if (its_end < 0) GTEST_SKIP() << "the sockets of another process cannot be seen here";
    EXPECT_EQ(option(its_end, TCP_USER_TIMEOUT), 60'000) << "something was sent";
    EXPECT_EQ(option(its_end, TCP_KEEPIDLE) + option(its_end, TCP_KEEPCNT) * option(its_end, TCP_KEEPINTVL),
              60)
        << "nothing was sent";
    int keeps_alive = 0;
    size = sizeof keeps_alive;
    getsockopt(its_end, SOL_SOCKET, SO_KEEPALIVE, &keeps_alive, &size);
    EXPECT_EQ(keeps_alive, 1);
    close(its_end);
}

}  // namespace
}  // namespace asip::test
