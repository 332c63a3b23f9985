// SPDX-License-Identifier: Apache-2.0
// Boards as Home Assistant is shown them: the real gateway, broker, agent and firmware.
#include <gmock/gmock.h>

#include <csignal>

#include "running_gateway.hpp"
#include "tests/integration/agent/rig.hpp"

namespace asip::test {
namespace {

using testing::HasSubstr;

constexpr const char* kDocument = "homeassistant/device/asip-uno1/config";
constexpr const char* kGateway = "asip/export/ha/$state";
constexpr const char* kBoard = "asip/export/ha/uno1/$state";
constexpr const char* kDistance = "asip/export/ha/uno1/distance-0";
constexpr const char* kServo = "asip/export/ha/uno1/servo-0-angle";
const std::vector<std::string> kOnDemand{"--reports", "on-demand"};
const std::vector<std::string> kShown{"homeassistant/#", "asip/export/#", "homie/#"};
constexpr const char* kError = "asip/export/ha/uno1/last-error";

class GatewayExport : public testing::Test {
  protected:
    GatewayExport() {
        for (const auto& filter : kShown)
            probe_.subscribe(filter);
    }

    std::unique_ptr<RunningGateway> start(const std::vector<std::string>& more = {"--home-assistant"}) {
        return std::make_unique<RunningGateway>(broker_.address(), more);
    }
    bool becomes(const std::string& topic, const std::string& payload) {
        return wait_until([&] { return probe_.last(topic) == payload; });
    }
    bool is_shown() {
        return wait_until([&] {
            const auto document = probe_.last(kDocument);
            return document && document->find("servo-0-angle") != std::string::npos;
        });
    }
    /// Topics that the broker keeps for a new reader.
    std::vector<std::string> retained() const {
        auto filters = kShown;
        filters.push_back("test/end");
        BusProbe reader(broker_.port(), filters);
        reader.publish("test/end", "x");
        wait_until([&] { return reader.count("test/end") > 0; });
        std::vector<std::string> topics;
        for (const auto& message : reader.messages())
            if (message.retain) topics.push_back(message.topic);
        return topics;
    }

    MosquittoBroker broker_;
    BusProbe probe_{broker_.port()};
};

// Each would be a message, and its acknowledgement, of each export.
TEST_F(GatewayExport, StateThatChangesAllTheTime_IsShownAFewTimesASecond_AndTheLastCounts) {
    const auto gateway = start();
    ASSERT_TRUE(gateway->ready());
    const std::string state = "asip/servicebus/uno1/$state";
    probe_.publish("asip/servicebus/uno1/$description", described("uno1"));
    probe_.publish(state, "online");
    ASSERT_TRUE(becomes(kBoard, "online")) << gateway->process().errors();
    gateway->process().signal(SIGSTOP);
    for (int i = 0; i < 4000; ++i)
        probe_.publish(state, i % 2 == 0 ? "lost" : "online", false, 0);
    probe_.publish(state, "offline");
    ASSERT_TRUE(wait_until([&] { return probe_.all_acknowledged(); }));
    gateway->process().signal(SIGCONT);
    ASSERT_TRUE(gateway->becomes("uno1", "offline"));
    EXPECT_TRUE(becomes(kBoard, "offline"));
    EXPECT_LT(probe_.count(kBoard), 300u);
}

class GatewayExportOfABoard : public GatewayExport {
  protected:
    SimulatedUno uno_;
    std::unique_ptr<Agent> agent_ = std::make_unique<Agent>(broker_, uno_.port(), kOnDemand);
};

TEST_F(GatewayExportOfABoard, BoardIsShownAndSet_AndItsStateFollowsItsProof) {
    auto gateway = start();
    ASSERT_TRUE(is_shown()) << gateway->process().errors();
    EXPECT_TRUE(becomes(kGateway, "online"));
    EXPECT_TRUE(becomes(kBoard, "online"));
    const auto document = nlohmann::json::parse(*probe_.last(kDocument));
    EXPECT_EQ(document["cmps"]["distance-0"]["dev_cla"], "distance");

    // Values on demand of the export alone.
    EXPECT_TRUE(wait_until([&] { return probe_.last(kDistance).has_value(); }));
    EXPECT_FALSE(probe_.last(kServo));
    probe_.publish(std::string(kServo) + "/set", "90");
    EXPECT_TRUE(becomes(kServo, "90")) << gateway->process().errors();

    // By another sender, too.
    probe_.publish("asip/uno1/servo/in", R"({"write":[0,45]})");
    EXPECT_TRUE(becomes(kServo, "45"));

    probe_.publish(std::string(kServo) + "/set", "181");
    EXPECT_TRUE(becomes(kError, "Servo 0 angle cannot be set to 181"));
    EXPECT_EQ(probe_.last(kServo), "45");

    // The board restarts: what its servo does then is not known.
    uno_.command("reset uno");
    agent_->kill();
    EXPECT_TRUE(becomes(kBoard, "offline"));
    agent_ = std::make_unique<Agent>(broker_, uno_.port(), kOnDemand);
    EXPECT_TRUE(becomes(kBoard, "online"));
    EXPECT_TRUE(becomes(kServo, "None"));
}

class GatewayExportOfMany : public GatewayExport {
  protected:
    void announce(const std::string& board) {
        probe_.publish("asip/servicebus/" + board + "/$description", described(board), true);
        probe_.publish("asip/servicebus/" + board + "/$state", "online", true);
        EXPECT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    }
};

TEST_F(GatewayExportOfMany, Clean_RemovesWhatIsLeft_UnlessAGatewayExports) {
    announce("uno1");
    auto gateway = start();
    ASSERT_TRUE(is_shown());
    const auto clean = [&] {
        return run({ASIP_PROGRAMS "/asip-gateway", "clean", "home-assistant", "--broker", broker_.address()});
    };
    const auto refused = clean();
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.errors, HasSubstr("exports now"));
    gateway->process().signal(SIGKILL);
    ASSERT_TRUE(becomes(kGateway, "offline"));
    const auto done = clean();
    EXPECT_EQ(done.status, 0) << done.errors;
    EXPECT_TRUE(retained().empty()) << retained().size();
}

TEST_F(GatewayExportOfMany, EachDialect_IsExportedAndCleanedBesideTheOthers) {
    announce("uno1");
    probe_.subscribe("spBv1.0/#");
    auto gateway = start({"--home-assistant", "--homie", "--sparkplug", "plant"});
    ASSERT_TRUE(is_shown());
    EXPECT_TRUE(becomes("homie/5/uno1/$state", "ready"));
    EXPECT_TRUE(becomes("homie/5/asip/$state", "ready"));
    EXPECT_TRUE(probe_.wait_for("spBv1.0/plant/DBIRTH/asip/uno1"));
    probe_.publish("asip/uno1/distance/out", R"({"distance":{"0":42}})");
    EXPECT_TRUE(becomes("homie/5/uno1/distance/distance-0", "42"));
    EXPECT_TRUE(becomes(kDistance, "42"));
    EXPECT_TRUE(probe_.wait_for("spBv1.0/plant/DDATA/asip/uno1"));
    gateway->process().signal(SIGKILL);
    EXPECT_TRUE(probe_.wait_for("spBv1.0/plant/NDEATH/asip"));
    ASSERT_TRUE(becomes("homie/5/asip/$state", "lost"));
    ASSERT_TRUE(becomes(kGateway, "offline"));
    const auto done = run({ASIP_PROGRAMS "/asip-gateway", "clean", "--broker", broker_.address()});
    EXPECT_EQ(done.status, 0) << done.errors;
    EXPECT_THAT(done.output, HasSubstr("Homie: nothing of the export is left"));
    EXPECT_THAT(done.output, HasSubstr("Sparkplug: nothing of the export is left"));
    EXPECT_TRUE(retained().empty()) << retained().size();
}

TEST_F(GatewayExportOfMany, HomeAssistantThatIsFound_IsNamedInTheLog) {
    auto gateway = start({});
    ASSERT_TRUE(gateway->ready());
    probe_.publish("homeassistant/status", "online");
    EXPECT_TRUE(
        gateway->process().wait_for_errors("with --home-assistant this gateway shows it every board"));
}

}  // namespace
}  // namespace asip::test
