// SPDX-License-Identifier: Apache-2.0
// What a gateway exports on a secured bus: with the rights that its credentials give, and no more.
#include <csignal>
#include <ostream>

#include "tests/integration/secure/secured_bus.hpp"

namespace asip::test {
namespace {

constexpr const char* kDescription =
    R"({"board":"uno1","session":"5f3a9c01","seq":1,"lease":600,"services":[)"
    R"({"name":"distance","id":"D","model":"distance@1","count":1},{"name":"servo","id":"S","model":"servo@1","count":1}]})";

struct Row {
    const char* name;
    const char* option;
    const char* gateway;   ///< topic of its state
    const char* online;    ///< there, while it exports
    const char* board;     ///< topic of something that a board has once
    const char* distance;  ///< topics of entities
    const char* servo;
    const char* reader;  ///< users
    const char* setter;
    friend void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }
};

const Row kRows[] = {
    {"HomeAssistant", "--home-assistant", "asip/export/ha/$state", "online",
     "homeassistant/device/asip-uno1/config", "asip/export/ha/uno1/distance-0",
     "asip/export/ha/uno1/servo-0-angle", "home-assistant", "home-assistant"},
    {"Homie", "--homie", "homie/5/asip/$state", "ready", "homie/5/uno1/$description",
     "homie/5/uno1/distance/distance-0", "homie/5/uno1/servo/servo-0-angle", "bob", "ann"},
};

class ExportsOnSecuredBus : public SecuredBus, public ::testing::WithParamInterface<Row> {
  protected:
    ExportsOnSecuredBus() {
        add({"board", "uno1"});
        add({"operator", "ann"});
        add({"viewer", "bob"});
        add({"gateway"});
        add({"home-assistant"});
        start_broker();
    }
    std::unique_ptr<ChildProcess> gateway() const {
        return std::make_unique<ChildProcess>(
            Words{ASIP_TEST_GATEWAY, "--http", "127.0.0.1:0", GetParam().option} + as("gateway"));
    }
};

TEST_P(ExportsOnSecuredBus, TwoGateways_NeedNoOtherRights_AndSendNothingTwice) {
    const auto& row = GetParam();
    auto board = probe("uno1", {"asip/uno1/+/in"});
    board.publish("asip/servicebus/uno1/$description", kDescription, true);
    board.publish("asip/servicebus/uno1/$state", "online", true);
    const auto reader = probe(row.reader, {row.gateway, row.board, row.distance, row.servo});
    auto setter = probe(row.setter, {});
    auto first = gateway();
    ASSERT_TRUE(reader.wait_for(row.gateway, row.online)) << first->errors();
    ASSERT_TRUE(wait_until([&] { return reader.count(row.board) > 0; })) << first->errors();
    board.publish("asip/uno1/distance/out", R"({"distance":[42]})");
    ASSERT_TRUE(reader.wait_for(row.distance, "42")) << first->errors();
    auto second = gateway();
    ASSERT_TRUE(second->wait_for_errors("listening  address"));

    const auto commands = [&] { return board.count("asip/uno1/servo/in"); };
    setter.publish(std::string(row.servo) + "/set", "90");
    ASSERT_TRUE(wait_until([&] { return commands() > 0; })) << first->errors();
    const auto documents = reader.count(row.board), values = reader.count(row.distance);

    first->signal(SIGKILL);
    ASSERT_TRUE(second->wait_for_errors("exports boards to")) << second->errors();
    ASSERT_TRUE(wait_until([&] { return reader.last(row.gateway) == row.online; })) << second->errors();
    board.publish("asip/uno1/distance/out", R"({"distance":[43]})");
    ASSERT_TRUE(reader.wait_for(row.distance, "43")) << second->errors();
    EXPECT_EQ(reader.count(row.board), documents);
    EXPECT_EQ(reader.count(row.distance), values + 1);
    EXPECT_EQ(commands(), 1u) << "of two gateways one commands";
    setter.publish(std::string(row.servo) + "/set", "91");
    EXPECT_TRUE(wait_until([&] { return commands() == 2; })) << second->errors();
    for (const auto& program : {first->errors(), second->errors()})
        for (const char* sign : {"deny", "denie", "Not authorized", "refuse"})
            EXPECT_EQ(program.find(sign), std::string::npos) << program;
}

TEST_P(ExportsOnSecuredBus, GatewayAndReader_MayDoNoMore) {
    const auto& row = GetParam();
    for (const char* topic : {"homeassistant/status", "homeassistant/sensor/uno1/config",
                              "homeassistant/device/uno1", "homie/4/uno1/$state", "homie/5",
                              "asip/export/other/x", "asip/uno1/distance/out", "asip/servicebus/uno1/$state"})
        EXPECT_FALSE(may_publish("gateway", topic)) << topic;
    for (const char* topic : {row.gateway, row.board, row.distance})
        EXPECT_FALSE(may_publish(row.reader, topic)) << topic;
    EXPECT_FALSE(may_publish("bob", std::string(row.servo) + "/set")) << "a viewer sets nothing";
    EXPECT_FALSE(may_publish("uno1", row.distance)) << "a board exports nothing";
}

INSTANTIATE_TEST_SUITE_P(Each, ExportsOnSecuredBus, testing::ValuesIn(kRows),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace asip::test
