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

TEST_F(GatewayOutcome, RepeatedOverTheNextWebSocket_IsAnsweredOnceMoreAndExecutedOnce) {
    const std::string command = R"({"command":"uno1/servo","write":[0,45],"id":"7"})";
    {
        Socket socket(port(), {}, kSocket);
        socket.send(command);
        ASSERT_TRUE(wait_until([&] { return known("7"); }));
    }
    Socket again(port(), {}, kSocket);
    again.send(command);
    agent_.process().signal(SIGCONT);
    const auto answer = again.json();
    EXPECT_EQ(answer["id"], "7");
    EXPECT_EQ(answer["status"], "ok") << answer;
    EXPECT_EQ(probe_.count("asip/uno1/servo/in"), 1u);
}

TEST_F(GatewayOutcome, NoAnswerInTime_IsATimeoutAndThenTheLateAnswer) {
    {
        Socket socket(port(), {}, kSocket);
        socket.send(R"({"command":"uno1/servo","write":[0,45],"id":"7","deadline_ms":100})");
        ASSERT_TRUE(wait_until([&] { return known("7"); }));
    }
    const auto timeout = outcome("7");
    EXPECT_EQ(timeout["answer"]["reason"], "no-answer") << timeout;
    agent_.process().signal(SIGCONT);
    EXPECT_TRUE(wait_until([&] { return get(port(), "/api/commands/7", kTab).json().value("late", false); }));
}

}  // namespace
}  // namespace asip::test
