// SPDX-License-Identifier: Apache-2.0
// Live streams with the real program and broker.
#include <gmock/gmock.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class GatewayStreams : public GatewayTest {
  protected:
    static nlohmann::json socket_event(Socket& socket) {
        auto message = socket.json();
        if (!message.is_object()) throw std::runtime_error("the connection was closed");
        return message;
    }
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

// A reader of a pattern keeps the last place of each service.
TEST_F(GatewayStreams, SocketOfAPatternCutAtEveryEvent_NoGapAndNoDuplicateInAnyService) {
    announce("uno1");
    announce("uno2");
    constexpr int kValues = 5;
    for (int cut = 0; cut <= 3 + 2 * kValues; ++cut) {
        nlohmann::json places = nlohmann::json::object();
        std::map<std::string, std::vector<int>> seen;
        const auto put = [&](int n) {
            for (const std::string board : {"uno1", "uno2"})
                probe_.publish("asip/" + board + "/distance/out", R"({"n":)" + std::to_string(n) + "}");
        };
        const auto read = [&](Socket& socket, int events, bool until_end = false) {
            while (events-- > 0) {
                const auto message = socket.json();
                ASSERT_TRUE(message.contains("event")) << message;
                ASSERT_NE(message["event"], "reset");
                const bool value = message["event"] == "value";
                const auto board = message.value("board", "");
                places[value ? board + "/distance" : "*"] = message["place"];
                if (value && !message.contains("age")) seen[board].push_back(message["value"]["n"]);
                if (until_end && seen["uno1"].size() && seen["uno2"].size() && seen["uno1"].back() == 99 &&
                    seen["uno2"].back() == 99)
                    return;
            }
        };
        const auto subscribe = [&](Socket& socket) {
            nlohmann::json request{{"subscribe", "uno*/distance"}, {"ref", 1}, {"after", places}};
            socket.send(request.dump());
            ASSERT_EQ(socket.json()["ok"], true);
        };
        // Each has a last value: the snapshot is two values and its end.
        put(-1);
        ASSERT_TRUE(wait_until([&] {
            return ask("/api/boards/uno2/services/distance/value").body.find("\"value\":-1}") !=
                   std::string::npos;
        }));
        {
            Socket first(port());
            subscribe(first);
            read(first, std::min(cut, 3));
            for (int n = 0; n < kValues; ++n)
                put(n);
            read(first, cut - 3);
        }
        Socket second(port());
        subscribe(second);
        const bool in_snapshot = cut < 3;
        if (!in_snapshot) read(second, 2 * kValues - (cut - 3));
        while (in_snapshot && !places.contains("*") && !HasFatalFailure())
            read(second, 1);
        put(99);
        read(second, 1000, true);
        for (const std::string board : {"uno1", "uno2"}) {
            std::vector<int> whole;
            for (int n = 0; n < kValues; ++n)
                whole.push_back(n);
            whole.push_back(99);
            // Cut within the snapshot, what the reader had not begun begins with what is the last value then.
            const bool begun = !in_snapshot || cut > (board == "uno1" ? 0 : 1);
            if (!begun) whole = {99};
            ASSERT_FALSE(seen[board].empty());
            if (!begun) seen[board] = {seen[board].back()};
            EXPECT_EQ(seen[board], whole) << board << ", cut behind " << cut;
        }
    }
}

TEST_F(GatewayStreams, SocketOfTheCatalogueCutAtEveryEvent_NoGapAndNoDuplicate) {
    announce("uno1");
    constexpr std::size_t kChanges = 6;
    for (std::size_t cut = 0; cut <= kChanges; ++cut) {
        std::vector<std::string> seen;
        std::string last;
        const auto read = [&](Socket& socket, std::size_t count) {
            while (seen.size() < count) {
                const auto message = socket.json();
                ASSERT_TRUE(message.contains("event")) << message;
                ASSERT_NE(message["event"], "reset");
                last = message.value("place", last);
                if (message["event"] == "state") seen.push_back(message["board"]["state"]);
            }
        };
        const auto subscribe = [&](Socket& socket) {
            nlohmann::json request{{"subscribe", "$catalogue"}, {"ref", 1}};
            if (!last.empty()) request["after"] = last;
            socket.send(request.dump());
            ASSERT_EQ(socket.json()["ok"], true);
        };
        {
            Socket first(port());
            subscribe(first);
            for (auto message = nlohmann::json::object(); message.value("event", "") != "snapshot-end";) {
                message = socket_event(first);
                last = message.value("place", last);
            }
            for (std::size_t i = 0; i < kChanges; ++i)
                probe_.publish("asip/servicebus/uno1/$state", i % 2 == 0 ? "sleeping" : "online");
            read(first, cut);
        }
        Socket second(port());
        subscribe(second);
        read(second, kChanges);
        probe_.publish("asip/servicebus/uno1/$state", "sleeping");
        read(second, kChanges + 1);
        probe_.publish("asip/servicebus/uno1/$state", "online");
        std::vector<std::string> whole;
        for (std::size_t i = 0; i <= kChanges; ++i)
            whole.push_back(i % 2 == 0 ? "sleeping" : "online");
        EXPECT_EQ(seen, whole) << "cut behind " << cut;
        ASSERT_TRUE(gateway_.becomes("uno1", "online"));
    }
}

TEST_F(GatewayStreams, CutAtEveryChangeOfTheCatalogue_NoGapAndNoDuplicate) {
    announce("uno1");
    constexpr int kChanges = 8;
    for (int cut = 0; cut <= kChanges; ++cut) {
        std::vector<std::string> seen;
        std::string last;
        const auto read = [&](EventStream& stream, std::size_t count) {
            while (seen.size() < count) {
                const auto event = stream.next();
                ASSERT_FALSE(event.kind.empty());
                ASSERT_NE(event.kind, "reset");
                if (!event.id.empty()) last = event.id;
                if (event.kind == "state")
                    seen.push_back(nlohmann::json::parse(event.data)["board"]["state"]);
            }
        };
        std::vector<std::string> whole;
        {
            EventStream first(port(), "/api/events");
            last = first.next("snapshot-end").id;
            for (int i = 0; i < kChanges; ++i) {
                whole.push_back(i % 2 == 0 ? "sleeping" : "online");
                probe_.publish("asip/servicebus/uno1/$state", whole.back());
            }
            read(first, static_cast<std::size_t>(cut));
        }
        EventStream second(port(), "/api/events?last_event_id=" + last);
        read(second, kChanges);
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

TEST_F(GatewayStreams, WebSocketsAfter_ResumesWithoutGap) {
    announce("uno1");
    std::string place;
    {
        Socket first(port());
        first.send(R"({"subscribe":"uno1/distance","ref":1})");
        first.json();
        place = first.json()["place"];
    }
    for (int n = 1; n <= 3; ++n)
        probe_.publish("asip/uno1/distance/out", R"({"n":)" + std::to_string(n) + "}");
    ASSERT_TRUE(wait_until(
        [&] { return ask("/api/boards/uno1/services/distance/values").json()["items"].size() == 3; }));
    Socket second(port());
    second.send(R"({"subscribe":"uno1/distance","ref":1,"after":")" + place + "\"}");
    EXPECT_EQ(second.json()["ok"], true);
    for (int n = 1; n <= 3; ++n)
        EXPECT_EQ(second.json()["value"]["n"], n);
    second.send(R"({"subscribe":"*/distance","ref":2,"after":")" + place + "\"}");
    EXPECT_THAT(second.json().value("error", ""), HasSubstr("of a pattern, an object"));
}

TEST_F(GatewayStreams, MaxHz_NewestValueAtMostSoOften) {
    announce("uno1");
    EventStream stream(port(), "/api/boards/uno1/services/distance/stream?max_hz=5");
    stream.next("snapshot-end");
    const auto begin = std::chrono::steady_clock::now();
    for (int n = 1; n <= 100; ++n) {
        probe_.publish("asip/uno1/distance/out", R"({"n":)" + std::to_string(n) + "}");
        ASSERT_TRUE(wait_until([&] { return probe_.all_acknowledged(); }));
    }
    int events = 0;
    for (int last = 0; last < 100; ++events)
        last = nlohmann::json::parse(stream.next("value").data)["value"]["n"];
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    EXPECT_LE(events, 2 + static_cast<int>(time.count() * 5));
}

TEST_F(GatewayStreams, MaxHzOutOfItsRange_IsRefused) {
    announce("uno1");
    for (const char* wrong : {"1e-300", "1e-10", "0.009", "-1", "1001", "1e308", "nan", "inf", ""}) {
        const auto answer = ask("/api/boards/uno1/services/distance/stream?max_hz=" + std::string(wrong));
        EXPECT_EQ(answer.status, 400) << wrong;
    }
}

TEST_F(GatewayStreams, TwoGatewaysOnOneBus_SayTheSame) {
    RunningGateway second(broker_.address());
    ASSERT_TRUE(second.ready());
    announce("uno1");
    ASSERT_TRUE(second.becomes("uno1", "online"));
    auto a = ask("/api/boards/uno1").json();
    auto b = get(second.port(), "/api/boards/uno1").json();
    for (auto* item : {&a, &b}) {
        for (const char* member : {"age", "first_seen", "last_seen", "since", "state_age"})
            item->erase(member);
    }
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
