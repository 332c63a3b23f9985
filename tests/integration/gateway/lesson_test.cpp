// SPDX-License-Identifier: Apache-2.0
// A lesson with the real program: a teacher by token, pupils by code, over HTTP and WebSocket.
#include <gmock/gmock.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class GatewayLesson : public testing::Test {
  protected:
    GatewayLesson() {
        const auto made =
            run({ASIP_PROGRAMS "/asip-gateway", "token", "operator", "miss", "--tokens", tokens_});
        teacher_ = {{"Authorization", "Bearer " + made.output.substr(0, made.output.find('\n'))}};
        start();
        for (const char* board : {"student-1", "student-2", "student-10"}) {
            probe_.publish("asip/servicebus/" + std::string(board) + "/$description", described(board));
            probe_.publish("asip/servicebus/" + std::string(board) + "/$state", "online");
        }
        EXPECT_TRUE(wait_until([&] {
            const auto listed = get(port(), "/api/boards?full=true", teacher_).json();
            return listed.contains("items") && listed["items"].size() == 3;
        }));
    }
    void start() {
        gateway_.reset();
        gateway_ = std::make_unique<RunningGateway>(
            broker_.address(), std::vector<std::string>{"--tokens", tokens_, "--config",
                                                        settings_file("trusted-proxy = true\n")});
        ASSERT_TRUE(gateway_->ready());
    }
    std::uint16_t port() const { return gateway_->port(); }
    json open(const std::string& body = R"({"boards":["student-*"],"minutes":45})") {
        const auto opened = post(port(), "/api/lessons", body, teacher_);
        EXPECT_EQ(opened.status, 201) << opened.body;
        return opened.json();
    }
    HttpAnswer join(const std::string& code, const std::string& address = "192.0.2.1") const {
        return post(port(), "/api/join", json{{"code", code}}.dump(), {{"X-Forwarded-For", address}});
    }
    static Headers cookie_of(const HttpAnswer& joined) {
        const auto found = joined.headers.find("set-cookie");
        if (found == joined.headers.end()) return {};
        return {{"Cookie", found->second.substr(0, found->second.find(';'))}};
    }

    TempDir folder_;
    std::string tokens_ = folder_.file("tokens");
    Headers teacher_;
    MosquittoBroker broker_;
    std::unique_ptr<RunningGateway> gateway_;
    BusProbe probe_{broker_.port()};
};

TEST_F(GatewayLesson, Pupil_CommandsItsBoardOverHttpAndWebSocket_AndNoOther) {
    const auto lesson = open();
    const auto joined = join(lesson["code"]);
    ASSERT_EQ(joined.status, 200) << joined.body;
    EXPECT_EQ(joined.json()["board"], "student-1");
    const auto pupil = cookie_of(joined);
    EXPECT_EQ(
        post(port(), "/api/boards/student-1/services/servo/commands/write?deadline_ms=50", "[0,90]", pupil)
            .status,
        504)
        << "sent, and no agent is there";
    ASSERT_TRUE(probe_.wait_for("asip/student-1/servo/in"));
    EXPECT_EQ(post(port(), "/api/boards/student-2/services/servo/commands/write", "[0,90]", pupil).status,
              404);

    Socket socket(port(), pupil);
    ASSERT_EQ(socket.status(), 101);
    socket.send(R"({"subscribe":"$catalogue","ref":1})");
    for (std::string text;;) {
        text = socket.message();
        EXPECT_THAT(text, Not(HasSubstr("student-2")));
        if (text.empty() || text.find("snapshot-end") != std::string::npos) break;
    }
    socket.send(R"({"subscribe":"*/*","ref":2})");
    socket.send(R"({"subscribe":"student-2/$values","ref":3})");
    socket.send(R"({"command":"student-2/servo","write":[0,90],"id":"7"})");
    bool refused = false;
    while (!refused) {
        const auto text = socket.message();
        ASSERT_FALSE(text.empty());
        EXPECT_THAT(text, Not(HasSubstr("\"board\":\"student-2\"")));
        refused = text.find("\"id\":\"7\"") != std::string::npos;
        if (refused) {
            EXPECT_THAT(text, HasSubstr("no board"));
        }
    }
    EXPECT_EQ(probe_.count("asip/student-2/servo/in"), 0u);
}

TEST_F(GatewayLesson, End_ClosesStreamsAndWebSocketsAtOnce_AndCommandsAre401) {
    const auto lesson = open();
    const auto pupil = cookie_of(join(lesson["code"]));
    Socket socket(port(), pupil);
    EventStream stream(port(), "/api/events", pupil);
    ASSERT_EQ(stream.next("snapshot-end").kind, "snapshot-end");
    const auto path = "/api/lessons/" + lesson["id"].get<std::string>();
    const auto began = std::chrono::steady_clock::now();
    EXPECT_EQ(request(port(), "DELETE", path, {}, teacher_).status, 204);
    EXPECT_EQ(socket.close_code(), 1008);
    EXPECT_TRUE(stream.wire().closed());
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(2));
    const auto command = post(port(), "/api/boards/student-1/services/servo/commands/write", "[0,90]", pupil);
    EXPECT_EQ(command.status, 401);
    EXPECT_THAT(command.detail(), HasSubstr("the lesson is over"));
    EXPECT_EQ(join(lesson["code"]).status, 404);
}

TEST_F(GatewayLesson, Restart_EndsLessons_AndPupilsAreToldSo) {
    const auto lesson = open();
    const auto pupil = cookie_of(join(lesson["code"]));
    EXPECT_EQ(get(port(), "/api/boards", pupil).status, 200);
    start();
    EXPECT_EQ(get(port(), "/api/lessons", teacher_).json()["items"].size(), 0u);
    const auto status = get(port(), "/api/status", pupil);
    EXPECT_EQ(status.status, 401);
    EXPECT_THAT(status.detail(), HasSubstr("the gateway was started anew"));
    EXPECT_EQ(join(lesson["code"]).status, 404);
}

}  // namespace
}  // namespace asip::test
