// SPDX-License-Identifier: Apache-2.0
// Dashboards with the real programs: kept on the bus, seen by every gateway, and shared by a link.
// docs/dashboards.md shows these requests by curl.
#include <gmock/gmock.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

constexpr const char* kLab = R"({"title":"Lab","widgets":[
  {"id":"far","kind":"value","board":"uno1","property":"distance/0"},
  {"id":"turn","kind":"slider","board":"uno1","property":"servo/0/angle"}]})";
const Headers kJson{{"Content-Type", "application/json"}};

class GatewayDashboards : public GatewayTest {
  protected:
    HttpAnswer put(const std::string& body, Headers headers = {}) {
        headers.insert(headers.end(), kJson.begin(), kJson.end());
        return request(port(), "PUT", "/api/dashboards/lab", body, headers);
    }
};

TEST_F(GatewayDashboards, KeptOnTheBus_EveryGatewayHasItAlsoAfterRestarts) {
    ASSERT_EQ(put(kLab).status, 201);
    EXPECT_EQ(put(kLab).status, 428);
    RunningGateway second(broker_.address());
    ASSERT_TRUE(second.ready());
    const auto there = get(second.port(), "/api/dashboards/lab");
    EXPECT_EQ(there.json()["title"], "Lab");
    EXPECT_EQ(probe_.count("asip/export/dashboard/lab"), 1u)
        << "what the broker has is not given to it again";
    auto changed = there.json();
    changed["title"] = "Hall";
    Headers tag{{"If-Match", there.headers.at("etag")}, kJson[0]};
    EXPECT_EQ(request(second.port(), "PUT", "/api/dashboards/lab", changed.dump(), tag).status, 200);
    EXPECT_TRUE(wait_until([&] { return ask("/api/dashboards/lab").json()["title"] == "Hall"; }));
    EXPECT_EQ(put(kLab, {tag[0]}).status, 412) << "the first gateway knows of the other's change";
    broker_.kill();
    EXPECT_EQ(put(kLab, {{"If-Match", "*"}}).status, 503);
    broker_.start();
    ASSERT_TRUE(wait_until([&] { return gateway_.ready() && second.ready(); }));
    RunningGateway third(broker_.address());
    ASSERT_TRUE(third.ready());
    EXPECT_TRUE(wait_until([&] {
        return get(third.port(), "/api/dashboards/lab").json().value("title", "") == "Hall";
    })) << "the broker kept nothing, and is given it again";
    EXPECT_EQ(request(third.port(), "DELETE", "/api/dashboards/lab").status, 204);
    EXPECT_TRUE(wait_until([&] { return ask("/api/dashboards/lab").status == 404; }));
    EXPECT_EQ(ask("/api/dashboards").json()["items"].size(), 0u);
    BusProbe late(broker_.port());  // the other one was ended with the first broker
    EXPECT_TRUE(late.wait_for("asip/export/dashboard/lab", R"({"removed":true})")) << "it was the last one";
}

TEST_F(GatewayDashboards, Link_ReadsAndUsesItsWidgetsOnlyAtEachGateway) {
    announce("uno1");
    announce("uno2");
    ASSERT_EQ(put(kLab).status, 201);
    const auto made = post(port(), "/api/dashboards/lab/links", R"({"control":true,"name":"hall"})", kJson);
    ASSERT_EQ(made.status, 201) << made.body;
    RunningGateway second(broker_.address());
    ASSERT_TRUE(second.ready());
    const auto link = made.json()["path"].get<std::string>();
    for (const auto at : {port(), second.port()}) {
        EXPECT_EQ(get(at, link + "api/dashboards/lab").status, 200);
        EXPECT_THAT(get(at, link).body, HasSubstr("<html"));
        for (const auto* path :
             {"boards", "boards/uno1", "services", "boards/uno1/services/distance/value", "history", "events",
              "boards/uno1/services/distance/stream", "models", "dashboards"})
            EXPECT_EQ(get(at, link + "api/" + path).status, 403) << path;
        EXPECT_EQ(get(at, link + "metrics").status, 403);
        EXPECT_EQ(post(at, link + "api/boards/uno1/stop", "{}", kJson).status, 403);
        EXPECT_EQ(post(at, link + "api/boards/uno1/services/servo/commands/write", "[0,9]", kJson).status,
                  403);
        // The second gateway came after the announcement, which is not retained here.
        EXPECT_EQ(post(at, link + "api/dashboards/lab/widgets/turn", R"({"value":181})", kJson).status,
                  at == port() ? 400 : 503);
    }
    Wire wire(port());
    const std::string body = R"({"value":90})";
    wire.send("POST " + link +
              "api/dashboards/lab/widgets/turn HTTP/1.1\r\nHost: localhost\r\nContent-Type: "
              "application/json\r\nContent-Length: " +
              std::to_string(body.size()) + "\r\n\r\n" + body);
    const auto sent = wait_until([&] { return probe_.last("asip/uno1/servo/in").has_value(); });
    ASSERT_TRUE(sent) << read_answer(wire).body;
    EXPECT_THAT(*probe_.last("asip/uno1/servo/in"), HasSubstr(R"("write":[0,90])"));
    EXPECT_EQ(request(port(), "DELETE", "/api/dashboards/lab/links/hall").status, 204);
    for (const auto at : {port(), second.port()})
        EXPECT_TRUE(wait_until([&] { return get(at, link + "api/dashboards/lab").status == 404; }));
}

}  // namespace
}  // namespace asip::test
