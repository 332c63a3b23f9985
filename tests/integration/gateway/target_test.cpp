// SPDX-License-Identifier: Apache-2.0
// Targets that are no path: in absolute form, as a proxy's clients send them, and the asterisk.
#include <gmock/gmock.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

class GatewayTarget : public GatewayTest {};

TEST_F(GatewayTarget, AbsoluteTarget_IsServedAndItsAuthorityIsTheHost) {
    announce("uno1");
    const auto own = "http://localhost:" + std::to_string(port());
    const auto stop = own + "/api/boards/uno1/services/servo/commands/write?deadline_ms=50";
    EXPECT_EQ(ask(own + "/api/boards/uno1").json()["board"], "uno1");
    EXPECT_EQ(ask(own).status, 200) << "the page";
    EXPECT_EQ(get(port(), own + "/api/boards", {{"Host", "evil.example"}}).status, 200);
    EXPECT_EQ(ask("http://evil.example/api/boards").status, 421) << "no proxy";
    EXPECT_EQ(ask("http://me@localhost/api/boards").status, 400);
    EXPECT_EQ(ask("https://localhost/api/boards").status, 421) << "this connection has no TLS";
    EXPECT_EQ(post(port(), stop, "[0,90]", {{"Origin", own}, {"Host", "evil.example"}}).status, 504);
    EXPECT_EQ(
        post(port(), stop, "[0,90]", {{"Origin", "http://evil.example"}, {"Host", "evil.example"}}).status,
        403);
    EXPECT_EQ(Socket(port(), {}, own + "/api/stream").status(), 101);
    EXPECT_EQ(Socket(port(), {{"Origin", "http://evil.example"}}, own + "/api/stream").status(), 403);
}

TEST_F(GatewayTarget, OptionsOfAll_SaysWhatMayBeSent) {
    const auto all = request(port(), "OPTIONS", "*");
    EXPECT_EQ(all.status, 204);
    EXPECT_EQ(all.headers.at("allow"), "GET, HEAD, POST, PUT, DELETE, OPTIONS");
    EXPECT_EQ(request(port(), "OPTIONS", "*", "", {{"Host", "evil.example"}}).status, 421);
    EXPECT_EQ(request(port(), "OPTIONS", "/").status, 204);
    EXPECT_EQ(ask("*").status, 400);
}

}  // namespace
}  // namespace asip::test
