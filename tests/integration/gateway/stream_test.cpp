// SPDX-License-Identifier: Apache-2.0
// Live streams with the real program and broker.
#include <gmock/gmock.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class GatewayStreams : public GatewayTest {
  protected:
};

// The connection is cut behind each event of a sequence in turn, and taken up again by its id.
TEST_F(GatewayStreams, CutAtEveryValue_NoGapAndNoDuplicate) {
    announce("uno1");
    const std::string target = "/api/boards/uno1/services/distance/stream";
    constexpr int kValues = 12;
    for (int cut = 0; cut <= kValues; ++cut) {
        std::vector<int> seen;
        std::string last;
        const auto read = [&](EventStream& stream, int count) {
            while (count > 0) {
                const auto event = stream.next();
                ASSERT_FALSE(event.kind.empty());
                ASSERT_NE(event.kind, "reset");
                if (!event.id.empty()) last = event.id;
                if (event.kind != "value" || event.id.empty()) continue;
                seen.push_back(nlohmann::json::parse(event.data)["value"]["n"]);
                --count;
            }
        };
        {
            EventStream first(port(), target);
            last = first.next("snapshot-end").id;
            for (int n = 0; n < kValues; ++n)
                probe_.publish("asip/uno1/distance/out", R"({"n":)" + std::to_string(n) + "}");
            read(first, cut);
        }
        EventStream second(port(), target, {{"Last-Event-ID", last}});
        read(second, kValues - cut);
        probe_.publish("asip/uno1/distance/out", R"({"n":99})");
        read(second, 1);
        std::vector<int> whole(kValues);
        for (int n = 0; n < kValues; ++n)
            whole[static_cast<std::size_t>(n)] = n;
        whole.push_back(99);
        EXPECT_EQ(seen, whole) << "cut behind " << cut;
    }
}

TEST_F(GatewayStreams, GatewayStartedAgain_ResetWithAReasonAndTheWholeState) {
    announce("uno1");
    EventStream stream(port(), "/api/events", {{"Last-Event-ID", "00000000-5"}});
    EXPECT_EQ(stream.next().kind, "reset");
    EXPECT_THAT(stream.next().data, HasSubstr("\"board\":\"uno1\""));
    EXPECT_EQ(stream.next().kind, "snapshot-end");
}

TEST_F(GatewayStreams, BrokerLostAndBack_IsReportedAndTheStreamGoesOn) {
    announce("uno1");
    EventStream stream(port(), "/api/events");
    stream.next("snapshot-end");
    broker_.kill();
    EXPECT_THAT(stream.next("status").data, HasSubstr("\"broker\":\"lost\""));
    EXPECT_EQ(ask("/readyz").status, 503);
    EXPECT_EQ(ask("/api/boards/uno1").status, 200) << "what is known is shown";
    EXPECT_EQ(post(port(), "/api/boards/uno1/services/servo/commands/write", "[0,90]").status, 503);
    EXPECT_EQ(ask("/api/events").status, 503) << "not confirmed before the bus is heard";
    broker_.start();
    EXPECT_THAT(stream.next("status").data, HasSubstr("\"broker\":\"connected\""));
    ASSERT_TRUE(gateway_.ready());
    BusProbe probe(broker_.port());
    probe.publish("asip/servicebus/uno2/$description", described("uno2"));
    EXPECT_THAT(stream.next("added").data, HasSubstr("uno2"));
}

TEST_F(GatewayStreams, WebSocket_ManySubscriptionsOneConnection) {
    announce("uno1");
    announce("uno2");
    Socket socket(port());
    socket.send(R"({"subscribe":"uno*/distance","ref":1})");
    EXPECT_EQ(socket.json()["ok"], true);
    EXPECT_EQ(socket.json()["event"], "snapshot-end");
    socket.send(R"({"subscribe":"$catalogue","ref":"c"})");
    EXPECT_EQ(socket.json()["ok"], true);
    EXPECT_EQ(socket.json()["board"]["board"], "uno1");
    EXPECT_EQ(socket.json()["board"]["board"], "uno2");
    EXPECT_EQ(socket.json()["event"], "snapshot-end");
    probe_.publish("asip/uno2/distance/out", R"({"distance":[7]})");
    const auto value = socket.json();
    EXPECT_EQ(value["ref"], 1);
    EXPECT_EQ(value["board"], "uno2");
    EXPECT_EQ(value["value"]["distance"][0], 7);
    probe_.publish("asip/servicebus/uno1/$state", "offline");
    const auto change = socket.json();
    EXPECT_EQ(change["ref"], "c");
    EXPECT_EQ(change["event"], "state");
    EXPECT_EQ(change["was"], "online");
    socket.send(R"({"unsubscribe":1})");
    EXPECT_EQ(socket.json()["ok"], true);
    probe_.publish("asip/uno2/distance/out", R"({"distance":[8]})");
    probe_.publish("asip/servicebus/uno1/$state", "online");
    EXPECT_EQ(socket.json()["event"], "state") << "and no value";
}

TEST_F(GatewayStreams, TwoGatewaysOnOneBus_SayTheSame) {
    RunningGateway second(broker_.address());
    ASSERT_TRUE(second.ready());
    announce("uno1");
    ASSERT_TRUE(second.becomes("uno1", "online"));
    auto a = ask("/api/boards/uno1").json();
    auto b = get(second.port(), "/api/boards/uno1").json();
    for (auto* item : {&a, &b})
        for (const char* member : {"age", "first_seen", "last_seen", "since", "state_age"})
            item->erase(member);
    EXPECT_EQ(a, b);
}

TEST_F(GatewayStreams, LongPoll_ReturnsWithTheNextValue) {
    announce("uno1");
    const auto place = ask("/api/boards/uno1/services/distance/value").json()["place"].get<std::string>();
    Wire wire(port());
    wire.send("GET /api/boards/uno1/services/distance/value?wait=30&after=" + place +
              " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(read_answer(wire, std::chrono::milliseconds(300)).status, 0) << "waits";
    probe_.publish("asip/uno1/distance/out", R"({"distance":[42]})");
    EXPECT_EQ(read_answer(wire).json()["events"]["distance"]["value"][0], 42);
}

}  // namespace
}  // namespace asip::test
