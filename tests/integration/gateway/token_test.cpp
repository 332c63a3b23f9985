// SPDX-License-Identifier: Apache-2.0
// Tokens and cookies with the real program.
#include <gmock/gmock.h>

#include <sys/stat.h>
#include <unistd.h>

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

TEST_F(GatewayTokens, Made_SaysWhereItIsTyped) {
    const auto told = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {ASIP_PROGRAMS "/asip-gateway", "token"});
        words.insert(words.end(), {"--tokens", file_});
        return run(words).errors;
    };
    EXPECT_THAT(told({"operator", "anna"}), HasSubstr("Type it at Sign in, on the gateway's page"));
    const auto link = told({"kiosk", "hall", "--boards", "uno1"});
    EXPECT_THAT(link, HasSubstr("/kiosk/TOKEN/"));
    EXPECT_THAT(link, testing::Not(HasSubstr("Sign in"))) << "its address is all that a kiosk needs";
}

TEST_F(GatewayTokens, LastLineWithoutItsEnd_TheNextTokenIsALineOfItsOwn) {
    const auto first = make("viewer", "hall");
    std::ifstream in(file_);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    text.pop_back();
    std::ofstream(file_) << text;
    const auto second = make("admin", "root");
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(first)).status, 200);
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(second)).status, 200);
}

// As its owner, so that the service can go on reading it; and whole or not at all.
TEST_F(GatewayTokens, FileThatIsThere_KeepsItsOwnerRightsAndLink) {
    make("viewer", "hall");
    using std::filesystem::perms;
    const auto rights = perms::owner_read | perms::owner_write | perms::group_read;
    std::filesystem::permissions(file_, rights);
    const bool root = geteuid() == 0;
    if (root) {
        ASSERT_EQ(chown(file_.c_str(), 12345, 23456), 0);
    }
    const auto real = file_;
    file_ = folder_.file("link");
    std::filesystem::create_symlink(real, file_);
    make("viewer", "lab");
    EXPECT_TRUE(std::filesystem::is_symlink(file_));
    EXPECT_EQ(std::filesystem::status(real).permissions(), rights);
    struct stat found{};
    ASSERT_EQ(stat(real.c_str(), &found), 0);
    if (root) {
        EXPECT_EQ(std::pair(found.st_uid, found.st_gid), (std::pair<uid_t, gid_t>(12345, 23456)));
    }
    std::size_t files = 0;
    for (const auto& each : std::filesystem::directory_iterator(std::filesystem::path(real).parent_path()))
        files += each.path().filename().string().starts_with("tokens");
    EXPECT_EQ(files, 1u) << "no draft is left";
}

TEST_F(GatewayTokens, FileThatCannotBeUsed_IsSaidAndNothingIsPrinted) {
    for (const std::string& file : {folder_.file("nowhere/tokens"), folder_.file("")}) {
        const auto made = run({ASIP_PROGRAMS "/asip-gateway", "token", "viewer", "hall", "--tokens", file});
        EXPECT_EQ(made.status, 2) << file;
        EXPECT_EQ(made.output, "");
        EXPECT_THAT(made.errors, HasSubstr(file)) << "with its name";
    }
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

TEST_F(GatewayTokens, AsipctlOpen_PrintsAnAddressThatLogsOneBrowserInOnce) {
    const auto operators = make("operator", "anna");
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    const std::string address = "http://127.0.0.1:" + std::to_string(gateway.port());
    const auto open = [&](const std::string& token, const std::string& board = "uno1") {
        return run({ASIP_PROGRAMS "/asipctl", "open", board, "--print", "--gateway", address, "--token-file",
                    folder_.write("token", token + "\n")});
    };
    BusProbe probe(broker_.port(), {});
    probe.publish("asip/servicebus/uno1/$description", described("uno1"), true);
    probe.publish("asip/servicebus/uno1/$state", "online", true);
    ASSERT_TRUE(
        wait_until([&] { return get(gateway.port(), "/api/boards/uno1", bearer(operators)).status == 200; }));
    const auto unknown = open(operators, "uno2");
    EXPECT_EQ(unknown.status, 4);
    EXPECT_EQ(unknown.output, "");
    EXPECT_THAT(unknown.errors, testing::AllOf(HasSubstr("uno2"), HasSubstr("uno1")));
    const auto opened = open(operators);
    ASSERT_EQ(opened.status, 0) << opened.errors;
    const auto page = opened.output.substr(0, opened.output.find('\n'));
    EXPECT_THAT(page, testing::StartsWith(address + "/?code="));
    EXPECT_THAT(page, testing::EndsWith("#/board/uno1"));
    EXPECT_THAT(page, testing::Not(HasSubstr(operators))) << "no lasting secret stands in an address";
    const auto target = page.substr(address.size(), page.find('#') - address.size());
    const auto entered = get(gateway.port(), target);
    ASSERT_EQ(entered.status, 303);
    const auto set = entered.headers.at("set-cookie");
    EXPECT_THAT(set, HasSubstr("; HttpOnly; SameSite=Strict"));
    const Headers cookie{{"Cookie", set.substr(0, set.find(';'))}};
    EXPECT_EQ(get(gateway.port(), "/api/boards", cookie).status, 200);
    EXPECT_EQ(get(gateway.port(), "/api/status", cookie).json()["you"]["name"], "anna");
    EXPECT_EQ(get(gateway.port(), target).status, 401) << "a second browser with the same address";

    probe.publish("asip/servicebus/uno1/$state", "offline", true);
    ASSERT_TRUE(wait_until([&] {
        return get(gateway.port(), "/api/boards/uno1", bearer(operators)).json().value("state", "") ==
               "offline";
    })) << "it has no agent that could be stopped";
    // The cookie is no way for another site to send something, and no token.
    Headers foreign = cookie;
    foreign.emplace_back("Origin", "http://evil.example");
    EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", foreign).status, 403);
    EXPECT_EQ(post(gateway.port(), "/api/stop", "{}", cookie).status, 200);
    EXPECT_EQ(get(gateway.port(), "/api/boards", bearer(set.substr(5, set.find(';') - 5))).status, 401);

    const auto refused = open("nonsense");
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.errors, HasSubstr("the token is not known"));
    EXPECT_EQ(run({ASIP_PROGRAMS "/asipctl", "open", "--gateway", "http://127.0.0.1:1"}).status, 4);
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

TEST_F(GatewayTokens, RevokedInTheMiddleOfAMessage_WhatItsClientStillSendsIsPassedOverUntilItClosesToo) {
    const auto viewer = make("viewer", "hall");
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    Socket socket(gateway.port(), {{"Sec-WebSocket-Protocol", "asip.bearer." + viewer}});
    ASSERT_EQ(socket.status(), 101);
    ASSERT_TRUE(socket.wire().send(std::string("\x81\x82\1\2\3\4z", 7))) << "a message of two letters";
    take_out("hall");
    ASSERT_EQ(socket.close_code(), 1008);
    ASSERT_TRUE(socket.wire().send("z"));
    for (int i = 0; i < 200; ++i)  // more than the buffers of both sides hold
        ASSERT_TRUE(socket.frame(0x82, std::string(60'000, 'x'))) << i;
    EXPECT_TRUE(socket.frame(0x88, std::string("\x03\xe8", 2)));
    EXPECT_TRUE(socket.wire().closed());
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
    const auto link = "/kiosk/" + kiosk + "/";
    EXPECT_THAT(get(gateway.port(), link).headers["content-security-policy"],
                HasSubstr("frame-ancestors https://wiki.example;"));
    EXPECT_THAT(get(gateway.port(), "/").headers["content-security-policy"],
                HasSubstr("frame-ancestors 'none'"));
    const auto bare = get(gateway.port(), "/kiosk/" + kiosk);
    EXPECT_EQ(bare.status, 308);
    EXPECT_EQ(bare.headers.at("location"), link);
    EXPECT_EQ(get(gateway.port(), link + "api/boards").headers["referrer-policy"], "no-referrer");
}

// What its page asks for, it asks for below the link: without a cookie, as in a frame of another site.
TEST_F(GatewayTokens, KioskLink_ServesPageApiAndStreamsBelowIt) {
    const auto kiosk = make("kiosk", "lobby", {"--boards", "uno1", "--services", "distance"});
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    const auto link = "/kiosk/" + kiosk + "/";
    BusProbe probe(broker_.port());
    for (const std::string board : {"uno1", "uno2"}) {
        probe.publish("asip/servicebus/" + board + "/$description", described(board));
        probe.publish("asip/servicebus/" + board + "/$state", "online");
    }
    const auto ask = [&](const std::string& path) { return get(gateway.port(), link + path); };
    ASSERT_TRUE(wait_until([&] { return ask("api/boards/uno1").status == 200; }));
    for (const std::string path : {"", "main.js", "ui/screens.js", "style.css", "api/status", "api/models"})
        EXPECT_EQ(ask(path).status, 200) << path;
    EXPECT_THAT(ask("").body, testing::Not(testing::ContainsRegex("(src|href)=\"/"))) << "relative addresses";
    EXPECT_EQ(ask("api/boards/uno2").status, 404);
    EXPECT_EQ(ask("api/boards").json()["items"].size(), 1u);
    EXPECT_EQ(ask("api/boards/uno1/services/servo").status, 404);
    EventStream stream(gateway.port(), link + "api/boards/uno1/services/distance/stream");
    ASSERT_EQ(stream.next("snapshot-end").kind, "snapshot-end");
    Socket socket(gateway.port(), {{"Origin", "http://localhost"}}, link + "api/stream");
    ASSERT_EQ(socket.status(), 101);
    socket.send(R"({"subscribe":"*/*","ref":1})");
    EXPECT_EQ(socket.json()["ok"], true);
    EXPECT_EQ(socket.json()["event"], "snapshot-end");
    probe.publish("asip/uno2/distance/out", R"({"distance":[1]})");
    probe.publish("asip/uno1/servo/out", R"({"n":1})");
    probe.publish("asip/uno1/distance/out", R"({"distance":[42]})");
    EXPECT_THAT(stream.next("value").data, HasSubstr("[42]"));
    EXPECT_EQ(socket.json()["value"], nlohmann::json::parse(R"({"distance":[42]})"));
    take_out("lobby");
    EXPECT_TRUE(stream.wire().closed(time_limit(std::chrono::milliseconds(2500)))) << "revoked";
    EXPECT_EQ(socket.close_code(), 1008);
    EXPECT_EQ(ask("").status, 404);
}

TEST_F(GatewayTokens, KioskLink_IsNoWayToAnythingElse) {
    const auto kiosk = make("kiosk", "lobby", {"--boards", "uno1"});
    const auto admin = make("admin", "root");
    RunningGateway gateway(broker_.address(), {"--tokens", file_});
    ASSERT_TRUE(gateway.ready());
    const auto port = gateway.port();
    const auto link = "/kiosk/" + kiosk + "/";
    for (const std::string& token :
         {admin, std::string("lobby"), kiosk.substr(1), kiosk + "x", std::string("x")})
        EXPECT_EQ(get(port, "/kiosk/" + token + "/api/boards").status, 404)
            << "only a kiosk's whole token is a link";
    EXPECT_EQ(post(port, link + "api/stop").status, 403);
    EXPECT_EQ(post(port, link + "api/codes").status, 403);
    EXPECT_EQ(request(port, "DELETE", link + "api/boards/uno1").status, 403);
    EXPECT_EQ(get(port, link + "metrics").status, 403);
    EXPECT_EQ(post(port, link + "api/stop", "{}", bearer(admin)).status, 403)
        << "whatever else the request brings";
    EXPECT_EQ(get(port, link + "api/status", bearer(admin)).json()["you"]["role"], "kiosk");
    EXPECT_EQ(get(port, "/kiosk/").status, 404);
    EXPECT_EQ(get(port, "/kiosk").status, 404);
    EXPECT_EQ(get(port, link + "kiosk/" + kiosk + "/").status, 404);
    EXPECT_EQ(get(port, link + "../../api/boards").status, 400);
    EXPECT_EQ(get(port, "/api/boards", bearer(kiosk)).status, 200) << "its token works as others do";
    EXPECT_EQ(post(port, "/api/stop", "{}", bearer(kiosk)).status, 403);
    EXPECT_EQ(gateway.process().errors().find(kiosk), std::string::npos) << "the log names no link";
}

}  // namespace
}  // namespace asip::test
