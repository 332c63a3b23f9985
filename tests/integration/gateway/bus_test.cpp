// SPDX-License-Identifier: Apache-2.0
// Everything real: Mosquitto, registry, agent, firmware in the simulator.
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <set>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"
#include "tests/support/tcp_relay.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

class GatewayBus : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(registry_.wait_for_errors("catalogue is complete"));
        ASSERT_TRUE(gateway_.becomes("uno1", "online"))
            << gateway_.process().errors() << agent_.process().errors();
    }
    std::uint16_t port() const { return gateway_.port(); }
    /// "command anna servo ok"
    static std::set<std::string> commands_in_history(RunningGateway& gateway, const Headers& headers) {
        const auto history = get(gateway.port(), "/api/boards/uno1/history?limit=100", headers).json();
        std::set<std::string> lines;
        for (const auto& item : history.value("items", nlohmann::json::array()))
            if (item.contains("by"))
                lines.insert(item.value("what", "") + " " + item.value("by", "") + " " +
                             item.value("service", "") + " " + item.value("status", ""));
        return lines;
    }
    HttpAnswer ask(const std::string& target) const { return get(port(), target); }

    MosquittoBroker broker_;
    TempDir folder_;
    ChildProcess registry_{{ASIP_PROGRAMS "/asip-registry", "--broker", broker_.address(), "--id", "r1",
                            "--history", folder_.file("history.db")}};
    SimulatedUno uno_;
    Agent agent_{broker_, uno_.port(), {"--config", settings_file("statistics = 1s\n")}};
    RunningGateway gateway_{broker_.address()};
};

TEST_F(GatewayBus, Command_IsExecutedAndItsProofComesBack) {
    const std::string servo = "/api/boards/uno1/services/servo";
    const auto model = ask(servo).json()["model"];
    EXPECT_EQ(model["name"], "servo");
    const auto moved = post(port(), servo + "/commands/write", "[0,90]");
    EXPECT_EQ(moved.status, 200) << moved.body;
    EXPECT_EQ(moved.json()["proof"], "fence");
    const auto refused = post(port(), servo + "/commands/write", R"({"servo":9,"angle":90})");
    EXPECT_EQ(refused.status, 422) << refused.body;
    EXPECT_GT(refused.json()["code"].get<int>(), 0);
    EXPECT_EQ(post(port(), servo + "/commands/write", "[0,900]").status, 400);
}

// The broker has more of what boards publish than the gateway takes.
TEST_F(GatewayBus, WhatBoardsPublishIsStuck_CommandsStopsAndQuestionsAreAnswered) {
    TcpRelay relay(broker_.port());
    RunningGateway gateway("127.0.0.1:" + std::to_string(relay.port()));
    ASSERT_TRUE(gateway.becomes("uno1", "online")) << gateway.process().errors();
    ASSERT_TRUE(wait_until([&] { return get(gateway.port(), "/readyz").status == 200; }));
    relay.cut([](std::string_view first) {
        return first.find("-commands") == std::string_view::npos &&
               first.find("-stop") == std::string_view::npos;
    });
    const auto moved = post(gateway.port(), "/api/boards/uno1/services/servo/commands/write", "[0,45]");
    EXPECT_EQ(moved.status, 200) << moved.body;
    EXPECT_EQ(get(gateway.port(), "/api/boards/uno1/history").status, 200);
    EXPECT_EQ(post(gateway.port(), "/api/boards/uno1/stop?once=true").status, 200);
}

TEST_F(GatewayBus, WebSocketCommands_SameIdInTwoTabsAreTwoCommands) {
    Socket one(port()), two(port());
    for (auto* socket : {&one, &two})
        socket->send(R"({"command":"uno1/servo","write":[0,45],"id":"7"})");
    for (auto* socket : {&one, &two}) {
        const auto answer = socket->json();
        EXPECT_EQ(answer["id"], "7");
        EXPECT_EQ(answer["status"], "ok") << answer;
    }
    one.send(R"({"command":"uno1/servo","write":[0,46],"id":"7"})");
    EXPECT_EQ(one.json()["reason"], "id-reused");
    one.send(R"({"command":"uno1/nothing","write":[],"id":"8"})");
    EXPECT_EQ(one.json()["status"], "refused");
}

// The sender's name: in the envelope, in the answer, on the error topic, in the logs of agent and gateway,
// and in the registry's history.
TEST_F(GatewayBus, NameOfTheToken_GoesWhereTheCommandGoesAndComesBack) {
    const auto file = folder_.file("tokens");
    const auto made = run({ASIP_PROGRAMS "/asip-gateway", "token", "operator+raw", "anna", "--tokens", file});
    const Headers anna{{"Authorization", "Bearer " + made.output.substr(0, made.output.find('\n'))}};
    RunningGateway gateway(broker_.address(), {"--tokens", file});
    ASSERT_TRUE(wait_until([&] { return get(gateway.port(), "/api/boards/uno1", anna).status == 200; }));
    BusProbe probe(broker_.port());
    const auto by_of = [](const std::string& text) {
        return nlohmann::json::parse(text, nullptr, false).value("by", "nobody");
    };
    const auto servo = "/api/boards/uno1/services/servo/commands/write";
    const auto moved = post(gateway.port(), servo, "[0,90]", anna);
    EXPECT_EQ(moved.status, 200) << moved.body;
    EXPECT_EQ(by_of(moved.body), "anna");
    const auto sent = probe.wait_for("asip/uno1/servo/in");
    ASSERT_TRUE(sent);
    const auto answer = probe.wait_for(sent->response_topic);
    ASSERT_TRUE(answer);
    EXPECT_EQ(by_of(answer->payload), "anna") << "as the agent answers it";

    EXPECT_EQ(by_of(post(gateway.port(), servo, R"({"servo":9,"angle":90})", anna).body), "anna");
    const auto error = probe.wait_for("asip/uno1/servo/error");
    ASSERT_TRUE(error);
    EXPECT_EQ(by_of(error->payload), "anna");

    Socket socket(gateway.port(), anna);
    socket.send(R"({"command":"uno1/servo","write":[0,45],"id":"7","by":"somebody","reply_to":"elsewhere"})");
    EXPECT_EQ(socket.json()["by"], "anna") << "nobody can pretend to be somebody else";
    EXPECT_EQ(probe.count("elsewhere"), 0u);

    const auto stopped = post(gateway.port(), "/api/boards/uno1/stop?once=true", "{}", anna);
    EXPECT_EQ(stopped.json()["boards"]["uno1"]["by"], "anna") << stopped.body;
    EXPECT_TRUE(agent_.process().wait_for_errors("stopped by a message .*by=anna"))
        << agent_.process().errors();
    for (const std::string line : {"by=anna target=uno1/servo .*90.*status=ok",
                                   "by=anna target=uno1/servo .*45", "by=anna target=uno1 .*status=ok"})
        EXPECT_TRUE(gateway.process().wait_for_errors("command  " + line)) << line;
    for (const std::string line : {"command anna servo ok", "command anna servo error", "stop anna  ok"})
        EXPECT_TRUE(wait_until([&] { return commands_in_history(gateway, anna).contains(line); })) << line;
}

TEST_F(GatewayBus, SentOverMqtt311_ItsSenderIsAMemberOfTheJson) {
    BusProbe probe(broker_.port(), {"mine", "asip/uno1/servo/error"});
    probe.publish("asip/uno1/servo/in", R"({"write":[0,90],"by":"anna","reply_to":"mine","id":"1"})");
    ASSERT_TRUE(probe.wait_for("mine"));
    EXPECT_EQ(nlohmann::json::parse(*probe.last("mine"))["by"], "anna");
    probe.publish("asip/uno1/servo/in", R"({"write":[0,900],"by":"anna"})");
    const auto error = probe.wait_for("asip/uno1/servo/error");
    ASSERT_TRUE(error);
    EXPECT_EQ(nlohmann::json::parse(error->payload)["by"], "anna") << error->payload;
}

// The page's commands as they stand there, each with a part of what it prints behind "#=>".
TEST_F(GatewayBus, CommandsOfTheDocumentation_PrintWhatItSays) {
    std::ifstream page(ASIP_GATEWAY_TESTS "/../../../docs/gateway.md");
    int commands = 0;
    for (std::string line; std::getline(page, line);) {
        const auto mark = line.find("#=> ");
        if (!line.starts_with("curl ") || mark == std::string::npos) continue;
        ++commands;
        auto command = line.substr(0, mark);
        const std::string documented = "127.0.0.1:8080";
        command.replace(command.find(documented), documented.size(), "127.0.0.1:" + std::to_string(port()));
        const auto printed = run({"sh", "-c", command});
        EXPECT_THAT(printed.output, HasSubstr(line.substr(mark + 4))) << command << printed.errors;
    }
    EXPECT_GT(commands, 10);
}

TEST_F(GatewayBus, HungAgent_Is504AndTheLateAnswerIsKept) {
    agent_.process().signal(19);
    const auto late = post(port(), "/api/boards/uno1/services/servo/commands/write?deadline_ms=300", "[0,10]",
                           {{"Idempotency-Key", "k1"}});
    EXPECT_EQ(late.status, 504);
    EXPECT_EQ(late.json()["reason"], "no-answer");
    EXPECT_EQ(late.headers.at("location"), "/api/commands/k1");
    agent_.process().signal(18);
    EXPECT_TRUE(wait_until([&] {
        const auto found = ask("/api/commands/k1").json();
        return found.value("late", false);
    })) << ask("/api/commands/k1").body;
}

}  // namespace
}  // namespace asip::test
