// SPDX-License-Identifier: Apache-2.0
// What one client, or one address, may take of the gateway: beyond it that client is told, and the others are
// served.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include "running_gateway.hpp"

namespace asip::test {
namespace {

TEST(GatewayLimits, TenThousandConnections_AreHeldAndOthersServed) {
    rlimit limit{};
    getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    ASSERT_GT(limit.rlim_cur, 10'500u) << "this test needs as many file descriptors";
    MosquittoBroker broker;
    RunningGateway gateway(
        broker.address(),
        {"--config", settings_file("header-time = 90s\nmax-connections-per-address = 11000\n")});
    const auto before = gateway.process().resident_bytes();
    std::vector<Wire> all;
    all.reserve(10'000);
    for (int i = 0; i < 10'000; ++i) {
        all.emplace_back(gateway.port());
        all.back().send("GET /api/events HTTP/1.1\r\nHost: localhost\r\n");
    }
    const auto open = [&] {
        const auto text = get(gateway.port(), "/metrics").body;
        const auto at = text.find("\nasip_gateway_http_connections ");
        return at == std::string::npos ? 0 : std::stoi(text.substr(at + 31));
    };
    EXPECT_TRUE(wait_until([&] { return open() > 10'000; })) << open();
    const auto each = (gateway.process().resident_bytes() - before) / 10'000;
    RecordProperty("bytes_per_connection", static_cast<int>(each));
    EXPECT_LT(each, memory_limit(16'000)) << "bytes a connection";
    all.clear();
    EXPECT_TRUE(wait_until([&] { return open() < 10; })) << open();
}

TEST(GatewayLimits, ConnectionsBeyondThem_Are503AndTheirPlaceComesBack) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address(),
                           {"--config", settings_file("max-connections-per-address = 5\n")});
    {
        std::vector<Wire> held;
        for (int i = 0; i < 5; ++i)
            held.emplace_back(gateway.port());
        EXPECT_TRUE(wait_until([&] { return get(gateway.port(), "/healthz").status == 503; }));
    }
    EXPECT_TRUE(wait_until([&] { return get(gateway.port(), "/healthz").status == 200; }));
}

// A thousand connections that each leave out the last byte of a body.
TEST(GatewayLimits, UnfinishedRequestsOfOneAddress_HaveABoundInBytesAndOthersAreServed) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address(),
                           {"--config", settings_file("max-connections-per-address = 2000\n")});
    ASSERT_TRUE(gateway.ready());
    const auto before = gateway.process().resident_bytes();
    std::vector<Wire> held;
    int refused = 0;
    for (int i = 0; i < 1000; ++i) {
        held.emplace_back(gateway.port());
        held.back().send(
            "POST /api/stop HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
            "Content-Length: 65000\r\n\r\n" +
            std::string(64'999, ' '));
    }
    EXPECT_EQ(get(gateway.port(), "/healthz").status, 200) << "what is short is served";
    for (auto& wire : held)
        refused += wire.closed(std::chrono::milliseconds(1));
    EXPECT_GT(refused, 500);
    EXPECT_LT(gateway.process().resident_bytes() - before, memory_limit(60u << 20));
    held.clear();
    EXPECT_TRUE(wait_until([&] {
        return post(gateway.port(), "/api/stop", "{}" + std::string(60'000, ' ')).status == 200;
    })) << "their room comes back";
}

// 20,000 of them cost 150 MB once.
TEST(GatewayLimits, WaitsOfClosedConnections_EndWithThem) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address());
    ASSERT_TRUE(gateway.ready());
    BusProbe probe(broker.port());
    probe.publish("asip/servicebus/uno1/$description", described("uno1"));
    probe.publish("asip/servicebus/uno1/$state", "online");
    ASSERT_TRUE(gateway.becomes("uno1", "online"));
    const auto streams = [&] {
        return get(gateway.port(), "/api/status").json()["streams"]["clients"].get<int>();
    };
    {
        std::vector<Wire> waiting;
        for (int i = 0; i < 64; ++i) {
            waiting.emplace_back(gateway.port());
            waiting.back().send(
                "GET /api/boards/uno1/services/servo/value?wait=60 HTTP/1.1\r\nHost: localhost\r\n\r\n");
        }
        EXPECT_TRUE(wait_until([&] { return streams() == 64; }));
        EXPECT_EQ(get(gateway.port(), "/api/boards/uno1/services/servo/value?wait=60").status, 429);
    }
    EXPECT_TRUE(wait_until([&] { return streams() == 0; })) << streams();
}

TEST(GatewayLimits, StreamsBeyondThem_Are429) {
    MosquittoBroker broker;
    RunningGateway gateway(broker.address(), {"--config", settings_file("max-streams = 2\n")});
    ASSERT_TRUE(gateway.ready());
    EventStream one(gateway.port(), "/api/events");
    EventStream two(gateway.port(), "/api/events");
    EXPECT_EQ(get(gateway.port(), "/api/events").status, 429);
}

class GatewayWithLittleRoom : public GatewayTest {
  protected:
    GatewayWithLittleRoom() : GatewayTest({"--config", settings_file("max-client-bytes = 262144\n")}) {}
};

/// What a client may have kept ends while a snapshot of a service is made for it: that is its own fault
/// alone.
TEST_F(GatewayWithLittleRoom, ClientBeyondItsBytesInASnapshot_IsToldAndTheOthersAreServed) {
    announce("uno1");
    nlohmann::json values;
    for (int i = 0; i < 12; ++i)
        values["k" + std::to_string(i)] = std::string(3000, 'x');
    probe_.publish("asip/uno1/distance/out", values.dump());
    ASSERT_TRUE(wait_until([&] {
        return ask("/api/boards/uno1/services/distance/value").body.find("k11") != std::string::npos;
    }));
    Socket greedy(port());
    for (int i = 0; i < 200; ++i)
        greedy.send(nlohmann::json{{"subscribe", "uno1/distance"}, {"ref", i}}.dump());
    bool told = false;
    for (auto text = greedy.message(); !text.empty() && !told; text = greedy.message())
        told = text.find("max-client-bytes") != std::string::npos || text.find("fault") != std::string::npos;
    EXPECT_TRUE(told);
    EXPECT_EQ(ask("/healthz").status, 200);
    EXPECT_TRUE(gateway_.process().running());
}

}  // namespace
}  // namespace asip::test
