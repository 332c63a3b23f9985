// SPDX-License-Identifier: Apache-2.0
// The gateway is stopped while clients wait: each is told what is known, and none sees a torn answer.
#include <gmock/gmock.h>

#include <csignal>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class GatewayLeave : public GatewayTest {
  protected:
    void SetUp() override { announce("uno1"); }
    std::optional<int> stop() {
        gateway_.process().signal(SIGTERM);
        return gateway_.process().wait_exit();
    }
    Wire waiting(const std::string& head, const std::string& body = {}) const {
        Wire wire(port());
        wire.send(head +
                  " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: " +
                  std::to_string(body.size()) + "\r\n\r\n" + body);
        return wire;
    }
};

TEST_F(GatewayLeave, StreamsAndWebSockets_EndAsTheyShould) {
    EventStream stream(port(), "/api/events");
    ASSERT_EQ(stream.next("snapshot-end").kind, "snapshot-end");
    Socket socket(port());
    socket.send(R"({"subscribe":"*/*","ref":1})");
    ASSERT_EQ(socket.message(), R"({"ref":1,"ok":true})");
    EXPECT_EQ(stop(), 0);
    EXPECT_NE(stream.wire().read_until("0\r\n\r\n"), "") << "the last chunk";
    EXPECT_TRUE(stream.wire().closed());
    EXPECT_EQ(socket.close_code(), 1001);
}

TEST_F(GatewayLeave, WhoWaits_IsToldWhatIsKnown) {
    const std::string service = "/api/boards/uno1/services/";
    auto command = waiting("POST " + service + "servo/commands/write", "[0,90]");
    auto value = waiting("GET " + service + "distance/value?wait=20");
    auto history = waiting("GET /api/history");
    Socket socket(port());
    socket.send(R"({"command":"uno1/servo","write":[0,90],"id":"7"})");
    ASSERT_TRUE(wait_until([&] { return probe_.count("asip/uno1/servo/in") == 2; }));
    EXPECT_EQ(stop(), 0);
    const auto answer = read_answer(command);
    EXPECT_EQ(answer.status, 504);
    EXPECT_THAT(answer.detail(), HasSubstr("the gateway ended before the answer"));
    EXPECT_EQ(read_answer(value).status, 200);
    EXPECT_EQ(read_answer(history).status, 503);
    const auto unproven = socket.json();
    EXPECT_EQ(unproven["id"], "7");
    EXPECT_EQ(unproven["status"], "timeout");
    EXPECT_EQ(socket.close_code(), 1001);
}

}  // namespace
}  // namespace asip::test
