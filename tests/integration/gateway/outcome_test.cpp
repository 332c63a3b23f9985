// SPDX-License-Identifier: Apache-2.0
// What became of a command whose connection was cut before its answer. Everything real.
#include <gmock/gmock.h>

#include <csignal>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using nlohmann::json;

const Headers kTab{{"Asip-Session", "tab-1"}};
const std::string kSocket = "/api/stream?session=tab-1";

class GatewayOutcome : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(gateway_.becomes("uno1", "online")) << gateway_.process().errors();
        // Nothing is answered until the connection is gone.
        agent_.process().signal(SIGSTOP);
    }
    std::uint16_t port() const { return gateway_.port(); }
    bool known(const std::string& id, const Headers& headers = kTab) const {
        return get(port(), "/api/commands/" + id, headers).status == 200;
    }
    json outcome(const std::string& id, const Headers& headers = kTab) const {
        json found;
        wait_until([&] {
            found = get(port(), "/api/commands/" + id, headers).json();
            return found.contains("answer");
        });
        return found;
    }

    MosquittoBroker broker_;
    SimulatedUno uno_;
    Agent agent_{broker_, uno_.port()};
    RunningGateway gateway_{broker_.address()};
    BusProbe probe_{broker_.port(), {"asip/uno1/servo/in"}};
};

TEST_F(GatewayOutcome, HttpConnectionCut_TheAnswerIsKept) {
    {
        Wire wire(port());
        wire.send(
            "POST /api/boards/uno1/services/servo/commands/write HTTP/1.1\r\nHost: localhost\r\n"
            "Content-Type: application/json\r\nIdempotency-Key: k1\r\nContent-Length: 6\r\n\r\n[0,90]");
        ASSERT_TRUE(wait_until([&] { return known("k1", {}); }));
    }
    EXPECT_FALSE(get(port(), "/api/commands/k1").json().contains("answer")) << "under way";
    agent_.process().signal(SIGCONT);
    const auto found = outcome("k1", {});
    EXPECT_EQ(found["answer"]["status"], "ok") << found;
    EXPECT_EQ(found["late"], false);
    EXPECT_EQ(found["target"], "uno1/servo");
}

TEST_F(GatewayOutcome, WebSocketCut_TheAnswerIsKeptForItsSession) {
    {
        Socket socket(port(), {}, kSocket);
        socket.send(R"({"command":"uno1/servo","write":[0,45],"id":"7"})");
        ASSERT_TRUE(wait_until([&] { return known("7"); }));
    }
    agent_.process().signal(SIGCONT);
    Socket again(port(), {}, kSocket);
    ASSERT_EQ(again.status(), 101);
    const auto found = outcome("7");
    EXPECT_EQ(found["answer"]["status"], "ok") << found;
    EXPECT_EQ(found["answer"]["id"], "7");
    EXPECT_FALSE(known("7", {{"Asip-Session", "tab-2"}})) << "another session's";
    EXPECT_FALSE(known("7", {}));
}

}  // namespace
}  // namespace asip::test
