// SPDX-License-Identifier: Apache-2.0
// Metrics as Prometheus reads them: promtool and a real server, with a real agent's numbers.
#include <gmock/gmock.h>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

class GatewayMetrics : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(gateway_.becomes("uno1", "online")) << gateway_.process().errors();
        ASSERT_EQ(post(gateway_.port(), "/api/boards/uno1/services/servo/commands/write", "[0,90]").status,
                  200);
        ASSERT_TRUE(wait_until([&] {
            return metrics().find("asip_board_commands_total{board=\"uno1\",outcome=\"ok\"}") !=
                   std::string::npos;
        })) << metrics();
    }
    std::string metrics(const Headers& headers = {}) const {
        return get(gateway_.port(), "/metrics", headers).body;
    }

    MosquittoBroker broker_;
    ChildProcess registry_{{ASIP_PROGRAMS "/asip-registry", "--broker", broker_.address(), "--id", "r1",
                            "--config", settings_file("stats-interval = 1s\n")}};
    SimulatedUno uno_;
    Agent agent_{broker_, uno_.port(), {"--config", settings_file("statistics = 1s\n")}};
    RunningGateway gateway_{broker_.address()};
};

TEST_F(GatewayMetrics, Promtool_FindsNothingToSay) {
    ChildProcess promtool({"promtool", "check", "metrics"});
    promtool.write_input(metrics());
    promtool.close_input();
    EXPECT_EQ(promtool.wait_exit(), 0) << promtool.output() << promtool.errors();
    EXPECT_EQ(promtool.errors(), "");
}

TEST_F(GatewayMetrics, Prometheus_Scrapes) {
    TempDir folder;
    const auto port = free_port();
    const auto config = folder.write(
        "prometheus.yml",
        "global: { scrape_interval: 1s, scrape_timeout: 1s }\nscrape_configs:\n  - job_name: asip\n"
        "    static_configs: [{ targets: [\"127.0.0.1:" +
            std::to_string(gateway_.port()) + "\"] }]\n");
    ChildProcess prometheus({"prometheus", "--config.file=" + config,
                             "--storage.tsdb.path=" + folder.file("data"),
                             "--web.listen-address=127.0.0.1:" + std::to_string(port)});
    ASSERT_TRUE(prometheus.wait_for_errors("Server is ready to receive web requests"));
    const auto value = [&](const std::string& query) -> std::string {
        const auto answer = get(port, "/api/v1/query?query=" + query, {{"Host", "127.0.0.1"}}).json();
        if (answer.value("status", "") != "success" || answer["data"]["result"].empty()) return {};
        return answer["data"]["result"][0]["value"][1];
    };
    EXPECT_TRUE(wait_until([&] { return value("up") == "1"; }, time_limit(std::chrono::seconds(30))))
        << prometheus.errors();
    EXPECT_TRUE(wait_until([&] { return value("asip_boards%7Bstate=%22online%22%7D") == "1"; }));
    EXPECT_TRUE(wait_until([&] { return !value("asip_board_lines_total").empty(); }));
}

}  // namespace
}  // namespace asip::test
