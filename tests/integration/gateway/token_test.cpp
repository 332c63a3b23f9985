// Tokens and cookies with the real program.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class GatewayTokens : public testing::Test {
  protected:
    std::string make(const std::string& role, const std::string& name, std::vector<std::string> more = {}) {
        std::vector<std::string> command{
            ASIP_PROGRAMS "/asip-gateway", "token", role, name, "--tokens", file_};
        command.insert(command.end(), more.begin(), more.end());
        const auto made = run(command);
        EXPECT_EQ(made.status, 0) << made.errors;
        return made.output.substr(0, made.output.find('\n'));
    }
    static Headers bearer(const std::string& token) { return {{"Authorization", "Bearer " + token}}; }
    void take_out(const std::string& name) {
        std::ifstream in(file_);
        std::string kept;
        for (std::string line; std::getline(in, line);) {
            if (line.find(" " + name + " ") == std::string::npos) kept += line + "\n";
        }
        std::ofstream(file_) << kept;
    }

    TempDir folder_;
    std::string file_ = folder_.file("tokens");
    MosquittoBroker broker_;
};

TEST_F(GatewayTokens, Made_IsShownOnceKeptHashedAndReadableByItsOwnerOnly) {
    const auto token = make("viewer", "hall");
    EXPECT_GE(token.size(), 43u);
    std::ifstream in(file_);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    EXPECT_THAT(text, testing::StartsWith("viewer hall "));
    EXPECT_EQ(text.find(token), std::string::npos);
    using std::filesystem::perms;
    EXPECT_EQ(std::filesystem::status(file_).permissions() & (perms::group_all | perms::others_all),
              perms::none);
    EXPECT_EQ(run({ASIP_PROGRAMS "/asip-gateway", "token", "viewer", "hall", "--tokens", file_}).status, 2);
    EXPECT_EQ(run({ASIP_PROGRAMS "/asip-gateway", "token", "viewr", "lab", "--tokens", file_}).status, 2);
}

TEST_F(GatewayTokens, Roles_AreKeptAndLoopbackIsNobody) {
    const auto viewer = make("viewer", "hall");
    const auto admin = make("admin", "root");
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    EXPECT_EQ(get(gateway.port(), "/api/boards").status, 401);
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(viewer)).status, 200);
    EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", bearer(viewer)).status, 403);
    EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", bearer(admin)).status, 200);
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(viewer.substr(1))).status, 401);
    EXPECT_EQ(get(gateway.port(), "/api/boards", {{"Cookie", "asip=" + viewer}}).status, 401)
        << "a token is no cookie";
    EXPECT_TRUE(gateway.process().wait_for_errors("request  by=root .*target=/api/stop"))
        << "who did what is logged";
}

TEST_F(GatewayTokens, Revoked_ItsOpenStreamsEndWithinASecond) {
    const auto viewer = make("viewer", "hall");
    const auto other = make("viewer", "lab");
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    EventStream stream(gateway.port(), "/api/events", bearer(viewer));
    EventStream kept(gateway.port(), "/api/events", bearer(other));
    Socket socket(gateway.port(), {{"Sec-WebSocket-Protocol", "asip.bearer." + viewer}});
    ASSERT_EQ(stream.next("snapshot-end").kind, "snapshot-end");
    ASSERT_EQ(kept.next("snapshot-end").kind, "snapshot-end");
    ASSERT_EQ(socket.status(), 101);
    take_out("hall");
    ASSERT_TRUE(gateway.process().wait_for_errors("tokens read .*tokens=1"));
    EXPECT_TRUE(stream.wire().closed(time_limit(std::chrono::milliseconds(1500))));
    EXPECT_EQ(socket.close_code(), 1008);
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(viewer)).status, 401);
    EXPECT_FALSE(kept.wire().closed(std::chrono::milliseconds(300)));
}

TEST_F(GatewayTokens, Expires_ItsOpenStreamsEnd) {
    const auto token = make("viewer", "brief", {"--until", "3s"});
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    EventStream stream(gateway.port(), "/api/events", bearer(token));
    ASSERT_EQ(stream.head().status, 200);
    EXPECT_TRUE(stream.wire().closed(std::chrono::seconds(6)));
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(token)).status, 401);
}

TEST_F(GatewayTokens, FileBecomesNonsense_TokensStayAsTheyWere) {
    const auto viewer = make("viewer", "hall");
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    std::ofstream(file_) << "nonsense\n";
    ASSERT_TRUE(gateway.process().wait_for_errors("the tokens stay as they were"));
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(viewer)).status, 200);
}

TEST_F(GatewayTokens, Kiosk_MayBeFramedByTheOriginsThatItsTokenNamesOnly) {
    const auto kiosk = make("kiosk", "lobby", {"--boards", "uno1", "--frames", "https://wiki.example"});
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    EXPECT_THAT(get(gateway.port(), "/kiosk/lobby").headers["content-security-policy"],
                HasSubstr("frame-ancestors https://wiki.example;"));
    EXPECT_THAT(get(gateway.port(), "/").headers["content-security-policy"],
                HasSubstr("frame-ancestors 'none'"));
    EXPECT_EQ(get(gateway.port(), "/kiosk/other").status, 404);
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(kiosk)).status, 200);
    EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", bearer(kiosk)).status, 403);
    EXPECT_EQ(post(gateway.port(), "/api/codes", "{}", bearer(kiosk)).status, 200);
}

}  // namespace
}  // namespace asip::test
