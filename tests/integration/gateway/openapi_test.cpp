// SPDX-License-Identifier: Apache-2.0
// The OpenAPI document is valid and true: a validator accepts it, and every operation with each documented
// status is driven from it (openapi/drive.mjs).
#include <gmock/gmock.h>

#include <csignal>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

class GatewayOpenapi : public testing::Test {
  protected:
    std::string make(const std::string& role, const std::string& name,
                     const std::vector<std::string>& more = {}) {
        std::vector<std::string> command{
            ASIP_PROGRAMS "/asip-gateway", "token", role, name, "--tokens", tokens_};
        command.insert(command.end(), more.begin(), more.end());
        const auto made = run(command);
        return made.output.substr(0, made.output.find('\n'));
    }
    Finished drive(const std::string& phase) { return drive(phase, gateway_); }
    Finished drive(const std::string& phase, const RunningGateway& gateway) {
        return run({"node", ASIP_GATEWAY_TESTS "/openapi/drive.mjs", ASIP_OPENAPI_MODULES,
                    "http://127.0.0.1:" + std::to_string(gateway.port()), phase, viewer_, admin_, kiosk_},
                   {}, std::chrono::seconds(90));
    }
    void start_registry(const std::vector<std::string>& more) {
        std::vector<std::string> command{ASIP_PROGRAMS "/asip-registry", "--broker", broker_.address(),
                                         "--id", "r1"};
        command.insert(command.end(), more.begin(), more.end());
        registry_ = std::make_unique<ChildProcess>(command);
        ASSERT_TRUE(registry_->wait_for_errors("catalogue is complete"));
    }
    void announce(BusProbe& probe, const std::string& board, const std::string& state) {
        probe.publish("asip/servicebus/" + board + "/$description", described(board));
        probe.publish("asip/servicebus/" + board + "/$state", state);
    }
    bool sees(const std::string& board, const std::string& state) { return sees(gateway_, board, state); }
    bool sees(const RunningGateway& gateway, const std::string& board, const std::string& state) {
        return wait_until([&] {
            const auto answer =
                get(gateway.port(), "/api/boards/" + board, {{"Authorization", "Bearer " + admin_}});
            return answer.status == 200 && answer.json().value("state", "") == state &&
                   (board == "mute" || answer.json().contains("description"));
        });
    }

    TempDir folder_;
    std::string tokens_ = folder_.file("tokens");
    std::string viewer_ = make("viewer", "hall");
    std::string admin_ = make("admin", "root");
    std::string kiosk_ = make("kiosk", "lobby", {"--boards", "uno1"});
    MosquittoBroker broker_;
    std::unique_ptr<ChildProcess> registry_;
    SimulatedUno uno_;
    Agent agent_{broker_, uno_.port()};
    RunningGateway gateway_{broker_.address(), {"--tokens", tokens_}};
};

TEST_F(GatewayOpenapi, EachOperationAndStatus_IsAsDocumented) {
    const auto installed =
        run({ASIP_GATEWAY_TESTS "/openapi/install", ASIP_OPENAPI_MODULES}, {}, std::chrono::seconds(70));
    ASSERT_EQ(installed.status, 0) << installed.errors;
    start_registry({"--history", folder_.file("history.db")});
    BusProbe probe(broker_.port());
    announce(probe, "gone", "offline");
    announce(probe, "lost", "lost");
    announce(probe, "frozen", "online");
    auto stopped = described("frozen", 2);  // until a user resumes it, and its agent answers nothing
    stopped.replace(1, 0, R"("state":{"is":"online","reason":"latched","age":1},)");
    probe.publish("asip/servicebus/frozen/$description", stopped);
    probe.publish("asip/servicebus", "mute");
    probe.publish("asip/servicebus/mute", "S1");
    ASSERT_TRUE(sees("uno1", "online"));
    ASSERT_TRUE(sees("frozen", "online"));
    ASSERT_TRUE(sees("mute", "online"));
    ASSERT_TRUE(sees("lost", "lost"));
    const auto up = drive("up");
    EXPECT_EQ(up.status, 0) << up.errors;
    RunningGateway without_parts(broker_.address(), {"--tokens", tokens_, "--config",
                                                     settings_file("no-metrics = true\nno-wot = true\n")});
    const auto without = drive("without", without_parts);
    EXPECT_EQ(without.status, 0) << without.errors;
    const auto flood = drive("flood");
    EXPECT_EQ(flood.status, 0) << flood.errors;
    RunningGateway narrow(broker_.address(),
                          {"--tokens", tokens_, "--config", settings_file("max-client-bytes = 262144\n")});
    ASSERT_TRUE(narrow.ready());
    announce(probe, "lost", "lost");
    ASSERT_TRUE(sees(narrow, "lost", "lost"));
    ASSERT_TRUE(sees(narrow, "uno1", "online"));
    registry_->signal(SIGSTOP);
    const auto stalled = drive("stalled", narrow);
    registry_->signal(SIGCONT);
    EXPECT_EQ(stalled.status, 0) << stalled.errors;
    probe.publish("asip/servicebus/frozen/$state", "offline");
    ASSERT_TRUE(sees("frozen", "offline"));
    const auto quiet = drive("quiet");
    EXPECT_EQ(quiet.status, 0) << quiet.errors;
    registry_->signal(15);
    registry_->wait_exit();
    start_registry({});
    const auto no_history = drive("nohistory");
    EXPECT_EQ(no_history.status, 0) << no_history.errors;
    broker_.kill();
    ASSERT_TRUE(wait_until([&] { return get(gateway_.port(), "/readyz").status == 503; }));
    const auto down = drive("down");
    EXPECT_EQ(down.status, 0) << down.errors;
}

}  // namespace
}  // namespace asip::test
