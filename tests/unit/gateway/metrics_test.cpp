// SPDX-License-Identifier: Apache-2.0
// Metrics of more boards than one answer has, and values of services.
#include "gateway/metrics/all_metrics.hpp"

#include <gmock/gmock.h>

#include <set>

#include "api_bench.hpp"

namespace asip::gateway::metrics {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(MetricsPart, EveryBoardIsInOnePart_AndThePartsAreAlike) {
    for (const std::size_t of : {1u, 2u, 5u, 100u}) {
        std::vector<std::size_t> sizes(of);
        for (int board = 0; board < 10'000; ++board) {
            std::size_t found = 0;
            for (std::size_t number = 1; number <= of; ++number) {
                if (!Part{number, of}.takes("board" + std::to_string(board))) continue;
                ++found;
                ++sizes[number - 1];
            }
            ASSERT_EQ(found, 1u) << board;
        }
        for (const auto size : sizes) {
            EXPECT_GT(size, 10'000 / of * 6 / 10);
            EXPECT_LT(size, 10'000 / of * 14 / 10 + 1);
        }
    }
    // A series must not move to another scrape at an upgrade.
    EXPECT_TRUE((Part{1, 2}.takes("desk") != Part{2, 2}.takes("desk")));
}

TEST(MetricsPart, Text_IsNumberAndCount) {
    ASSERT_TRUE(Part::parse("2/4"));
    EXPECT_EQ(Part::parse("2/4")->number, 2u);
    EXPECT_EQ(Part::parse("2/4")->of, 4u);
    for (const char* wrong : {"", "2", "/", "0/4", "5/4", "1/0", "1/101", "-1/4", "a/b", "1/4/2", "1/4 "}) {
        const auto refused = Part::parse(wrong);
        ASSERT_FALSE(refused) << wrong;
        EXPECT_THAT(refused.error(), HasSubstr("such as 2/4"));
    }
}

class MetricsApiTest : public ApiTest {
  protected:
    MetricsApiTest() : ApiTest(Role::kAdmin) {
        for (const std::string board : {"desk", "hall", "shed"}) {
            bus("asip/servicebus/" + board + "/$description",
                nlohmann::json{{"board", board},
                               {"session", "s1"},
                               {"seq", 1},
                               {"lease", 60},
                               {"services",
                                {{{"name", "distance"},
                                  {"id", "D"},
                                  {"model", "distance@1"},
                                  {"title", "D"},
                                  {"count", 2}},
                                 {{"name", "servo"}, {"id", "S"}, {"model", "servo@1"}, {"title", "S"}}}}}
                    .dump());
            bus("asip/servicebus/" + board + "/$state", "online");
            bus("asip/" + board + "/distance/out", R"({"distance":{"0":42,"1":7}})");
            bus("asip/" + board + "/servo/set", R"({"write":{"0":90}})");
        }
    }
    std::string metrics(const std::string& query = {}) {
        const auto answer = ask("GET", "/metrics" + query);
        EXPECT_EQ(answer->status(), 200) << query;
        return std::string(answer->response->text());
    }
    static std::size_t count(const std::string& text, const std::string& what) {
        std::size_t found = 0;
        for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
            ++found;
        return found;
    }
};

TEST_F(MetricsApiTest, MoreBoardsThanOneAnswerHas_AreReadInParts) {
    for (int board = 0; board < 5000; ++board) {
        const auto name = "b" + std::to_string(board);
        bus("asip/servicebus/" + name + "/$description",
            R"({"board":")" + name + R"(","session":"s","seq":1,"lease":60,"services":[]})");
        bus("asip/servicebus/" + name + "/$stats", R"({"uptime":1})");
    }
    const auto whole = metrics();
    EXPECT_EQ(count(whole, "asip_board_agent_uptime_seconds{"), kMaxBoards);
    EXPECT_THAT(whole, HasSubstr("asip_gateway_unshown_boards 3000\n"));
    std::set<std::string> seen;
    for (const std::string part : {"1/4", "2/4", "3/4", "4/4"}) {
        const auto text = metrics("?part=" + part);
        EXPECT_THAT(text, HasSubstr("asip_gateway_unshown_boards 0\n"));
        EXPECT_EQ(count(text, "asip_gateway_build_info{"), part == "1/4" ? 1u : 0u);
        EXPECT_EQ(count(text, "asip_boards{"), part == "1/4" ? count(whole, "asip_boards{") : 0u);
        const std::string name = "asip_board_agent_uptime_seconds{board=\"";
        for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
            const auto begin = at + name.size();
            EXPECT_TRUE(seen.insert(text.substr(begin, text.find('"', begin) - begin)).second);
        }
    }
    EXPECT_EQ(seen.size(), 5000u);
}

/// Others are served between two steps.
TEST_F(MetricsApiTest, AnswerAboutManyBoards_IsMadeInSteps) {
    for (int board = 0; board < 2000; ++board) {
        const auto name = "b" + std::to_string(board);
        bus("asip/servicebus/" + name + "/$description",
            R"({"board":")" + name +
                R"(","session":"s","seq":1,"lease":60,"services":[{"name":"distance","id":"D","model":"distance@1"}]})");
        bus("asip/" + name + "/distance/out", R"({"distance":[42]})");
        bus("asip/servicebus/" + name + "/$stats", R"({"uptime":1})");
    }
    const auto answer = get("/metrics?values=*/*");
    EXPECT_EQ(count(std::string(answer->response->text()), "asip_value{"), 2006u);
    EXPECT_GT(answer->steps, 2003 + 2000 / Writer::kRead + 20 * (2000 / Writer::kWritten));
}

TEST_F(MetricsApiTest, Numbers_AreOfBoardsServicesCommandsAndTheGateway) {
    bus("asip/servicebus/desk/$stats", R"({"uptime":1,"line":{"bytes_in":5,"bytes_out":7}})");
    ask("POST", "/api/boards/desk/services/servo/commands/write", "[0,90]");
    answer(R"({"status":"ok","proof":"fence"})");
    const auto text = metrics();
    for (const char* line : {"asip_services{asip_service=\"servo\"} 3\n", "asip_boards{state=\"online\"} 3\n",
                             "asip_gateway_commands_total{outcome=\"ok\"} 1\n",
                             "asip_gateway_command_duration_seconds_bucket{le=\"+Inf\"} 1\n",
                             "asip_board_line_bytes_total{board=\"desk\",direction=\"in\"} 5\n"})
        EXPECT_THAT(text, HasSubstr(line));
    EXPECT_THAT(text, Not(HasSubstr("quantile")));
    const auto open = ask("GET", "/metrics", {}, {{"accept", "application/openmetrics-text; version=1.0.0"}});
    EXPECT_TRUE(open->response->text().ends_with("# EOF\n"));
    EXPECT_THAT(std::string(open->response->text()), HasSubstr("# TYPE asip_gateway_commands counter\n"));
}

TEST_F(MetricsApiTest, ChosenServices_ShowTheirLastValues) {
    EXPECT_THAT(metrics(), Not(HasSubstr("asip_value")));
    const auto text = metrics("?values=d*/distance,hall/*");
    EXPECT_THAT(text, HasSubstr("asip_value{board=\"desk\",property=\"distance/0\"} 42\n"));
    EXPECT_THAT(text, HasSubstr("asip_value{board=\"hall\",property=\"distance/1\"} 7\n"));
    EXPECT_THAT(text, Not(HasSubstr("asip_value{board=\"shed\"")));
    EXPECT_EQ(count(metrics("?values=desk/distance,*/distance,desk/*"), "asip_value{board=\"desk\""), 2u)
        << "once";
    std::size_t in_parts = 0;
    for (const std::string part : {"1/3", "2/3", "3/3"})
        in_parts += count(metrics("?values=*/distance&part=" + part), "asip_value{");
    EXPECT_EQ(in_parts, 6u);
    for (const char* wrong : {"?values=desk", "?values=/distance", "?values=desk/", "?values=desk/distance,,",
                              "?part=0/2", "?part=x"})
        EXPECT_EQ(ask("GET", std::string("/metrics") + wrong)->status(), 400) << wrong;
    std::string many = "?values=desk/distance";
    for (int i = 0; i < 20; ++i)
        many += ",desk/distance";
    EXPECT_EQ(ask("GET", "/metrics" + many)->status(), 400);
}

}  // namespace
}  // namespace asip::gateway::metrics
