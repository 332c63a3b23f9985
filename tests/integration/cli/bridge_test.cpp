// SPDX-License-Identifier: Apache-2.0
// Two brokers with a bridge as Debian's Mosquitto makes it by default, which speaks MQTT 3.1.1: the board at
// one of them, its users at the other one.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

class BridgeTest : public BusTest {
  protected:
    std::string board_file() const {
        return folder_.write("desk.json",
                             std::string(R"({"name":"desk","board":"uno","image":")") + ASIP_IMAGES +
                                 R"(/asip_uno_services.elf","link":")" + folder_.file("port") +
                                 R"(","parts":[{"kind":"ultrasonic","name":"distance","trigger":7,)"
                                 R"("echo":7,"distance":42},{"kind":"servo","name":"servo","pin":9}]})");
    }
    std::unique_ptr<MosquittoBroker> make_site(const std::vector<std::string>& more) const {
        MosquittoBroker::Options options;
        options.extra_lines = {"connection hub", "address " + broker_.address(), "topic # both 1"};
        options.extra_lines.insert(options.extra_lines.end(), more.begin(), more.end());
        return std::make_unique<MosquittoBroker>(options);
    }
    void begin(const std::vector<std::string>& more = {}) {
        ASSERT_TRUE(sim_.wait_for_output("desk .*port")) << sim_.errors();
        agent_ = std::make_unique<ChildProcess>(
            Words{ASIP_PROGRAMS "/asip-agent", "--serial", folder_.file("port"), "--name", "desk"},
            environment());
        registry_ = std::make_unique<ChildProcess>(Words{ASIP_PROGRAMS "/asip-registry", "--id", "r1"},
                                                   environment());
        ASSERT_TRUE(probe_.wait_for("asip/servicebus/desk/$state", "online")) << agent_->errors();
        site_ = make_site(more);
        BusProbe there(site_->port());
        ASSERT_TRUE(there.wait_for("asip/servicebus/desk/$state", "online"));
        ASSERT_TRUE(there.wait_for("asip/servicebus/desk/$description"));
    }
    Finished at_site(const Words& arguments) const {
        return run(program(arguments), {{"ASIP_BROKER", site_->address()}});
    }

    TempDir folder_;
    ChildProcess sim_{{ASIP_PROGRAMS "/asip-sim", "--no-socket", board_file()}};
    std::unique_ptr<ChildProcess> agent_, registry_;
    std::unique_ptr<MosquittoBroker> site_;
};

TEST_F(BridgeTest, AsDebianConfiguresIt_CommandsAreAnsweredAndTheAgentIsNotBlamed) {
    begin();
    const auto moved = at_site({"send", "desk/servo", "write", "0", "90"});
    EXPECT_EQ(moved.output, "ok\n") << moved.errors;
    EXPECT_EQ(at_site({"send", "desk/servo", "write", "9", "90"}).status, 1) << "the board's error";
    EXPECT_THAT(at_site({"send", "desk", "--raw", "#,?"}).output, HasSubstr("ATmega328P"));
    EXPECT_THAT(at_site({"get", "desk/distance/0"}).output, MatchesRegex("4[123] cm\n"));
    EXPECT_EQ(at_site({"ping", "desk", "-c", "2", "-i", "0"}).status, 0);
    EXPECT_EQ(at_site({"label", "desk", "room=lab"}).status, 0);
    EXPECT_THAT(at_site({"list"}).output, HasSubstr("desk"));
    EXPECT_EQ(at_site({"stop", "desk", "--once"}).status, 0);
    const auto doctor = at_site({"doctor"});
    EXPECT_THAT(doctor.output, HasSubstr("1 board answers: desk"));
    EXPECT_THAT(doctor.output, HasSubstr("bridge_protocol_version mqttv50"));
    EXPECT_THAT(doctor.output, Not(HasSubstr("nothing answers for it")));
}

TEST_F(BridgeTest, ThatSpeaksMqtt5_IsNotMentioned) {
    begin({"bridge_protocol_version mqttv50"});
    EXPECT_EQ(at_site({"send", "desk/servo", "write", "0", "90"}).output, "ok\n");
    EXPECT_THAT(at_site({"doctor"}).output, Not(HasSubstr("drops the properties")));
}

TEST_F(BridgeTest, GatewayAtTheOtherBroker_CommandsAreAnswered) {
    begin();
    ChildProcess gateway(
        {ASIP_PROGRAMS "/asip-gateway", "--broker", site_->address(), "--http", "127.0.0.1:0"});
    const auto line = gateway.wait_for_errors("listening  address=http://127\\.0\\.0\\.1:[0-9]+");
    ASSERT_TRUE(line);
    const auto begin_at = line->find("http://");
    const auto url = line->substr(begin_at, line->find(' ', begin_at) - begin_at);
    Finished answer;
    EXPECT_TRUE(wait_until([&] {
        answer = run({"curl", "-s", "-X", "POST", "-H", "Content-Type: application/json", "-d", "[0,90]",
                      url + "/api/boards/desk/services/servo/commands/write"});
        return answer.output.find(R"("status":"ok")") != std::string::npos;
    })) << answer.output;
}

}  // namespace
}  // namespace asip::test
