// SPDX-License-Identifier: Apache-2.0
// A Sparkplug host on a secured bus: with the rights of an operator, as the gateway has those of a gateway,
// and no more.
#include <csignal>

#include "gateway/export/sparkplug_payload.hpp"
#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test::sparkplug_host {
namespace {

namespace sparkplug = gateway::exports::sparkplug;

constexpr const char* kDescription =
    R"({"board":"uno1","session":"5f3a9c01","seq":1,"lease":600,"services":[)"
    R"({"name":"distance","id":"D","model":"distance@1","count":1},{"name":"servo","id":"S","model":"servo@1","count":1}]})";
constexpr const char* kBirth = "spBv1.0/plant/NBIRTH/asip";
constexpr const char* kDeath = "spBv1.0/plant/NDEATH/asip";
constexpr const char* kBoardBirth = "spBv1.0/plant/DBIRTH/asip/uno1";
constexpr const char* kData = "spBv1.0/plant/DDATA/asip/uno1";
constexpr const char* kHost = "spBv1.0/STATE/scada";

std::string wish(const std::string& metric, sparkplug::Value value) {
    sparkplug::Payload payload;
    payload.metrics.emplace_back();
    payload.metrics.back().name = metric;
    payload.metrics.back().value = std::move(value);
    return sparkplug::write(payload);
}

/// Nothing: there is none.
std::optional<std::int64_t> bd_seq(const std::optional<std::string>& bytes) {
    const auto payload = sparkplug::read(bytes.value_or(""));
    if (payload)
        for (const auto& metric : payload->metrics)
            if (metric.name == "bdSeq") return std::get<std::int64_t>(metric.value);
    return std::nullopt;
}

class SparkplugOnSecuredBus : public SecuredBus {
  protected:
    SparkplugOnSecuredBus() {
        add({"board", "uno1"});
        add({"operator", "ann"});
        add({"viewer", "bob"});
        add({"gateway"});
        start_broker();
    }
    std::unique_ptr<ChildProcess> gateway() const {
        return std::make_unique<ChildProcess>(Words{ASIP_TEST_GATEWAY, "--http", "127.0.0.1:0", "--sparkplug",
                                                    "plant", "--config",
                                                    settings_file("sparkplug-host = scada\n")} +
                                              as("gateway"));
    }
};

TEST_F(SparkplugOnSecuredBus, TwoGateways_NeedNoOtherRights_AndTheirNumbersGrow) {
    auto board = probe("uno1", {"asip/uno1/+/in"});
    board.publish("asip/servicebus/uno1/$description", kDescription, true);
    board.publish("asip/servicebus/uno1/$state", "online", true);
    const auto viewer = probe("bob", {"spBv1.0/plant/#"});
    auto host = probe("ann", {"spBv1.0/plant/#"});
    auto first = gateway();
    ASSERT_TRUE(first->wait_for_errors("exports boards to Sparkplug as plant/asip")) << first->errors();
    EXPECT_EQ(host.count(kBirth), 0u) << "the host is not there";
    host.publish(kHost, R"({"online":true,"timestamp":1})", true);
    ASSERT_TRUE(wait_until([&] { return host.count(kBoardBirth) > 0; })) << first->errors();
    board.publish("asip/uno1/distance/out", R"({"distance":[42]})");
    ASSERT_TRUE(wait_until([&] { return viewer.count(kData) > 0; })) << first->errors();
    auto second = gateway();
    ASSERT_TRUE(second->wait_for_errors("listening  address"));
    const auto births = host.count(kBirth);
    host.publish("spBv1.0/plant/NCMD/asip", wish("Node Control/Rebirth", true));
    ASSERT_TRUE(wait_until([&] { return host.count(kBirth) == births + 1; })) << first->errors();
    const auto number = bd_seq(host.last(kBirth));
    ASSERT_TRUE(number);

    const auto commands = [&] { return board.count("asip/uno1/servo/in"); };
    host.publish("spBv1.0/plant/DCMD/asip/uno1", wish("servo/0/angle", std::int64_t{90}));
    ASSERT_TRUE(wait_until([&] { return commands() > 0; })) << first->errors();
    first->signal(SIGKILL);
    ASSERT_TRUE(wait_until([&] { return host.count(kDeath) > 0; }));
    EXPECT_EQ(bd_seq(host.last(kDeath)), number);
    ASSERT_TRUE(second->wait_for_errors("exports boards to Sparkplug")) << second->errors();
    ASSERT_TRUE(wait_until([&] { return bd_seq(host.last(kBirth)) == *number + 1; })) << second->errors();
    EXPECT_EQ(commands(), 1u) << "of two gateways one commands";
    host.publish("spBv1.0/plant/DCMD/asip/uno1", wish("servo/0/angle", std::int64_t{91}));
    EXPECT_TRUE(wait_until([&] { return commands() == 2; })) << second->errors();
    for (const auto& program : {first->errors(), second->errors()})
        for (const char* sign : {"deny", "denie", "Not authorized", "refuse"})
            EXPECT_EQ(program.find(sign), std::string::npos) << program;
}

TEST_F(SparkplugOnSecuredBus, ViewerAndBoard_MaySayNothingThere) {
    for (const char* topic : {kBirth, kDeath, kBoardBirth, kData, kHost, "spBv1.0/plant/NCMD/asip",
                              "spBv1.0/plant/DCMD/asip/uno1"}) {
        EXPECT_FALSE(may_publish("bob", topic)) << topic;
        EXPECT_FALSE(may_publish("uno1", topic)) << topic;
    }
    for (const char* topic : {kBirth, kDeath, kBoardBirth, kData})
        EXPECT_FALSE(may_publish("ann", topic)) << topic;
    EXPECT_FALSE(may_publish("gateway", "spBv1.0/plant/OTHER/asip"));
}

}  // namespace
}  // namespace asip::test::sparkplug_host
