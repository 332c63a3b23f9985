// SPDX-License-Identifier: Apache-2.0
// The table of literal bytes through an agent: what published clients write to its TCP port, and publish on
// the bus, reaches a board of ASIP 0.4 as the requests that such a board would have executed.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/integration/agent/fake_port.hpp"
#include "tests/integration/agent/rig.hpp"
#include "tests/literal/literal_table.hpp"
#include "tests/support/patterns.hpp"

namespace asip::test {
namespace {

class LiteralSocket {
  public:
    explicit LiteralSocket(std::uint16_t port) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    }
    ~LiteralSocket() { close(fd_); }
    LiteralSocket(const LiteralSocket&) = delete;
    LiteralSocket& operator=(const LiteralSocket&) = delete;
    void send(std::string_view bytes) {
        ASSERT_TRUE(connected_);
        ASSERT_EQ(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), ssize_t(bytes.size()));
    }

  private:
    int fd_;
    bool connected_ = false;
};

class LiteralClients : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(wait_state(probe_, "online")) << agent_.process().errors();
        seen_ = fake_.heard().size();
    }
    /// What the board heard since the last call, but for questions of the agent, and periods of before that
    /// it sets again because this board never reports; a number without its decimals.
    bool hears(const std::vector<std::string>& wanted) {
        std::vector<std::string> heard;
        const bool all = wait_until(
            [&] {
                const auto lines = fake_.heard();
                heard.clear();
                for (std::size_t i = seen_; i < lines.size(); ++i) {
                    const bool asked =
                        lines[i] == "#,?" || lines[i] == "#,N" || lines[i].substr(1, 3) == ",A,";
                    const auto line = without_matches(lines[i], "\\.[0-9]+");
                    const bool is_wanted = std::find(wanted.begin(), wanted.end(), line) != wanted.end();
                    if (is_wanted || !asked) heard.push_back(line);
                }
                return heard.size() >= wanted.size();
            },
            4s);
        seen_ = fake_.heard().size();
        if (wanted.front()[0] == '#') return all;  // the agent asks the same
        EXPECT_EQ(heard, wanted);
        return all && heard == wanted;
    }

    MosquittoBroker broker_;
    FakePort fake_;
    BusProbe probe_{broker_.port(), {"asip/servicebus/#"}};
    std::uint16_t port_ = free_port();
    Agent agent_{broker_, fake_.path(), {"--listen", std::to_string(port_), "--keep-outputs"}};
    std::size_t seen_ = 0;
};

TEST_F(LiteralClients, OverTcp_AreUnderstoodAsBy04) {
    for (const auto& row : literal_rows("tcp")) {
        LiteralSocket client(port_);
        client.send(row.bytes());
        EXPECT_TRUE(hears(row.executes)) << row.name();
    }
}

TEST_F(LiteralClients, TwoAtOnce_AreNotMixed) {
    LiteralSocket one(port_), other(port_);
    one.send("M,m,1,1");
    other.send("M,m,0,2");
    one.send("00");
    other.send("55");
    EXPECT_TRUE(wait_until([&] {
        const auto heard = fake_.heard();
        return std::count(heard.begin(), heard.end(), "M,m,1,100") == 1 &&
               std::count(heard.begin(), heard.end(), "M,m,0,255") == 1;
    }));
}

TEST_F(LiteralClients, OverMqtt_AreUnderstoodAsBefore) {
    for (const auto& row : literal_rows("mqtt")) {
        for (const auto& write : row.writes)
            probe_.publish("asip/uno1/in", write);
        EXPECT_TRUE(hears(row.executes)) << row.name();
    }
}

}  // namespace
}  // namespace asip::test
