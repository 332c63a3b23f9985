// SPDX-License-Identifier: Apache-2.0
// The gateway at a broker with the rules that are shipped: they allow what it needs, and no more.
#include <gmock/gmock.h>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class SecuredGateway : public testing::Test {
  protected:
    static MosquittoBroker::Options rules() {
        MosquittoBroker::Options options;
        for (const std::string user : {"uno1", "B4", "registry", "gateway"})
            options.users.emplace_back(user, "of-" + user);
        options.extra_lines = {"acl_file " ASIP_PACKAGING "/mosquitto/asip-secured.acl"};
        return options;
    }
    std::vector<std::string> as(const std::string& user) const {
        return {"--user", user, "--password-file", folder_.write(user, "of-" + user + "\n")};
    }
    std::vector<std::string> registry_command() const {
        std::vector<std::string> command{
            ASIP_PROGRAMS "/asip-registry", "--broker", broker_.address(), "--id", "r1", "--history",
            folder_.file("history.db")};
        const auto user = as("registry");
        command.insert(command.end(), user.begin(), user.end());
        return command;
    }
    // One connection a message: libmosquitto 2.0.11 loses the connection when a message is refused.
    bool may_write(const std::string& topic) const {
        const auto published = run({"mosquitto_pub", "-V", "5", "-q", "1", "-h", "127.0.0.1", "-p",
                                    std::to_string(broker_.port()), "-u", "gateway", "-P", "of-gateway", "-t",
                                    topic, "-m", "{}"});
        return published.errors.find("Not authorized") == std::string::npos;
    }

    TempDir folder_;
    MosquittoBroker broker_{rules()};
    SimulatedUno uno_;
    ChildProcess registry_{registry_command()};
    Agent agent_{broker_, uno_.port(), as("uno1")};
    RunningGateway gateway_{broker_.address(), as("gateway")};
};

TEST_F(SecuredGateway, ShippedRules_AllowWhatItDoes) {
    const auto port = gateway_.port();
    ASSERT_TRUE(registry_.wait_for_errors("catalogue is complete")) << registry_.errors();
    ASSERT_TRUE(gateway_.becomes("uno1", "online")) << gateway_.process().errors();
    EventStream values(port, "/api/boards/uno1/services/distance/stream");
    ASSERT_EQ(values.next("snapshot-end").kind, "snapshot-end");
    EXPECT_EQ(post(port, "/api/boards/uno1/services/distance/commands/measure").status, 200);
    EXPECT_EQ(values.next("value").kind, "value");
    EXPECT_EQ(post(port, "/api/boards/uno1/raw", R"({"lines":["I,P,13,3"]})").status, 200);
    EXPECT_EQ(post(port, "/api/boards/uno1/raw", R"({"lines":["I,d,99,1"]})").status, 422);
    EXPECT_EQ(post(port, "/api/stop").status, 200);
    EXPECT_EQ(request(port, "PUT", "/api/dashboards/lab", R"({"widgets":[]})",
                      {{"Content-Type", "application/json"}})
                  .status,
              201);
    BusProbe paper_only(broker_.port(), {}, {.user = "B4", .password = "of-B4"});
    paper_only.publish("asip/servicebus/B4", "S1");
    EXPECT_TRUE(wait_until([&] { return get(port, "/api/boards/B4/services/S1").status == 200; }));
    paper_only.publish("asip/B4/out", "@D,e,1,{7}");
    paper_only.publish("asip/B4/S1/out", "7");
    EXPECT_TRUE(wait_until([&] {
        return get(port, "/api/boards/B4/services/S1/value").body.find("\"value\":7") != std::string::npos;
    })) << get(port, "/api/boards/B4/services/S1/value").body;
    EXPECT_EQ(get(port, "/api/history").status, 200);
    EXPECT_TRUE(wait_until([&] {
        const auto registries = get(port, "/api/status").json()["registries"];
        return registries.size() == 1 && registries[0]["state"] == "online" &&
               registries[0].contains("stats");
    })) << get(port, "/api/status").body;
    EXPECT_THAT(gateway_.process().errors(), Not(HasSubstr("refuses")));
    EXPECT_EQ(broker_.log().find("Denied"), std::string::npos) << broker_.log();
}

TEST_F(SecuredGateway, ShippedRules_LetItSpeakForNobodyElse) {
    for (const std::string topic :
         {"asip/uno1/in", "asip/uno1/servo/in", "asip/uno1/$stop", "asip/registry/query",
          "asip/registry/r1/query", "asip/servicebus/$probe"})
        EXPECT_TRUE(may_write(topic)) << topic;
    for (const std::string topic :
         {"asip/servicebus/uno1", "asip/servicebus/uno1/$state", "asip/servicebus/uno1/$description",
          "asip/uno1/out", "asip/uno1/servo/out", "asip/uno1/servo/error", "asip/registry/r1/$state",
          "elsewhere"})
        EXPECT_FALSE(may_write(topic)) << topic;
}

}  // namespace
}  // namespace asip::test
