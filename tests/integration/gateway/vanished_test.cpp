// SPDX-License-Identifier: Apache-2.0
// Clients that are gone: what the gateway keeps of them, and for how long.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <netinet/tcp.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

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

/// A network of this test's own, with a cable to another one in which clients are.
class OwnNetwork {
  public:
    static constexpr const char* kAddress = "10.99.0.1";

    OwnNetwork() : before_(open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC)) {
        if (before_ < 0 || unshare(CLONE_NEWNET) != 0) return;
        ours_ = true;
        clients_ = std::make_unique<ChildProcess>(
            std::vector<std::string>{"unshare", "-n", "sh", "-c", "echo ready; exec sleep 600"});
        if (!clients_->wait_for_output("ready")) return;
        works_ = ip({"link", "set", "lo", "up"}) &&
                 ip({"link", "add", "ours", "type", "veth", "peer", "name", "theirs", "netns", pid()}) &&
                 ip({"addr", "add", std::string(kAddress) + "/30", "dev", "ours"}) &&
                 ip({"link", "set", "ours", "up"}) &&
                 at_clients({"ip", "addr", "add", "10.99.0.2/30", "dev", "theirs"}) &&
                 at_clients({"ip", "link", "set", "theirs", "up"});
    }
    ~OwnNetwork() {
        clients_.reset();
        if (ours_) setns(before_, CLONE_NEWNET);
        if (before_ >= 0) close(before_);
    }
    bool works() const { return works_; }
    std::vector<std::string> words_at_clients(const std::vector<std::string>& words) const {
        std::vector<std::string> all{"nsenter", "-t", pid(), "-n"};
        all.insert(all.end(), words.begin(), words.end());
        return all;
    }
    /// Nothing of the clients comes any more, no FIN and no RST either.
    bool pull_the_cable() const { return at_clients({"ip", "link", "set", "theirs", "down"}); }

  private:
    std::string pid() const { return std::to_string(clients_->pid()); }
    bool at_clients(const std::vector<std::string>& words) const {
        return run(words_at_clients(words)).status == 0;
    }
    static bool ip(std::vector<std::string> words) {
        words.insert(words.begin(), "ip");
        return run(words).status == 0;
    }

    int before_;
    bool ours_ = false, works_ = false;
    std::unique_ptr<ChildProcess> clients_;
};

class GatewayBehindACable : public testing::Test {
  protected:
    GatewayBehindACable() {
        if (!network_.works()) return;
        broker_ = std::make_unique<MosquittoBroker>();
        const auto port = std::to_string(port_);
        gateway_ = std::make_unique<ChildProcess>(std::vector<std::string>{
            ASIP_PROGRAMS "/asip-gateway", "--broker", broker_->address(), "--anonymous", "viewer", "--http",
            "127.0.0.1:" + port + "," + OwnNetwork::kAddress + ":" + port});
    }
    nlohmann::json streams() const {
        const auto status = get(port_, "/api/status").json();
        return status.contains("streams") ? status["streams"]["clients"] : nlohmann::json();
    }

    static constexpr std::uint16_t port_ = 8080;
    OwnNetwork network_;
    std::unique_ptr<MosquittoBroker> broker_;
    std::unique_ptr<ChildProcess> gateway_;
};

/// One to which something is sent (a comment each 15 s), and one to which nothing is.
TEST_F(GatewayBehindACable, ClientsThatVanishWithoutAWord_AreGoneSoon) {
    if (!network_.works()) GTEST_SKIP() << "needs the right to make networks (root, or CAP_SYS_ADMIN)";
    ASSERT_TRUE(gateway_->wait_for_errors("listening  address=http://127")) << gateway_->errors();
    ASSERT_TRUE(wait_until([&] { return get(port_, "/readyz").status == 200; })) << gateway_->errors();
    const auto host = std::string(OwnNetwork::kAddress) + ":" + std::to_string(port_);
    ChildProcess stream(network_.words_at_clients({"curl", "-sN", "http://" + host + "/api/events"}));
    const auto handshake =
        "GET /api/stream HTTP/1.1\\r\\nHost: " + host +
        "\\r\\nUpgrade: websocket\\r\\nConnection: Upgrade\\r\\nSec-WebSocket-Version: 13\\r\\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\\r\\n\\r\\n";
    ChildProcess socket(
        network_.words_at_clients({"bash", "-c",
                                   "exec 3<>/dev/tcp/" + std::string(OwnNetwork::kAddress) + "/" +
                                       std::to_string(port_) + "; printf '" + handshake + "' >&3; cat <&3"}));
    ASSERT_TRUE(stream.wait_for_output("snapshot-end")) << stream.errors();
    ASSERT_TRUE(socket.wait_for_output("101 ")) << socket.output() << socket.errors();
    ASSERT_TRUE(wait_until([&] { return streams() == 2; })) << streams();
    ASSERT_TRUE(network_.pull_the_cable());
    EXPECT_EQ(streams(), 2) << "nothing told the gateway";
    EXPECT_TRUE(wait_until([&] { return streams() == 0; }, std::chrono::seconds(120))) << streams();
}

}  // namespace
}  // namespace asip::test
