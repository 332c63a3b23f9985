// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "simulated_program.hpp"

namespace asip::caller {
namespace {

const std::string kMotors = "asip/robot/motors/in";

class HoldTest : public testing::Test, protected SimulatedProgram {
  protected:
    void begin(const std::string& payload = "m,0,120") {
        connect();
        hold_ = caller->hold(
            {.topic = kMotors, .payload = payload}, 300ms,
            [this](const bus::Reply& reply) { replies.push_back(reply); },
            [this](const bus::Reply& reply) { ended_.push_back(reply); }, now);
        command_ = taken(kMotors).at(0);
        id_ = json::parse(command_.payload).at("id");
    }
    void hold() {
        begin();
        answer(command_, {{"status", "ok"}}, "1f3c09aa-5000");
    }

    Caller::Hold hold_;
    mqtt::Message command_;
    std::string id_;
    std::vector<bus::Reply> ended_;
};

TEST_F(HoldTest, Command_CarriesForHowLongItHolds) {
    begin();
    EXPECT_EQ(json::parse(command_.payload).at("raw"), "m,0,120");
    EXPECT_EQ(json::parse(command_.payload).at("hold_ms"), 300);
    begin(R"({"power":[0,120]})");
    EXPECT_EQ(json::parse(command_.payload).at("power"), (json{0, 120}));
    EXPECT_EQ(json::parse(command_.payload).at("hold_ms"), 300);
}

TEST_F(HoldTest, Renewals_ComeThreeTimesInItsTimeByIdAndClock) {
    hold();
    ASSERT_EQ(replies.size(), 1u);
    pass(1s);
    const auto renewals = taken(kMotors);
    EXPECT_EQ(renewals.size(), 11u);  // one at once
    for (std::size_t i = 0; i < renewals.size(); ++i) {
        const auto members = json::parse(renewals[i].payload);
        EXPECT_EQ(members.at("renew"), id_);
        EXPECT_EQ(members.at("hold_ms"), 300);
        EXPECT_EQ(members.at("clock"), "1f3c09aa-" + std::to_string(5001 + 100 * i));
        EXPECT_EQ(renewals[i].expiry_seconds, 1u);
    }
}

TEST_F(HoldTest, CommandThatWasNotExecuted_IsNotRenewed) {
    begin();
    answer(command_, {{"status", "refused"}, {"reason", "stopped"}});
    pass(1min);
    EXPECT_EQ(replies.size(), 1u);
    EXPECT_TRUE(taken(kMotors).empty());
    begin();
    pass(1min);  // no answer
    EXPECT_TRUE(taken(kMotors).empty());
}

TEST_F(HoldTest, AgentThatHoldsItNoMore_EndsIt) {
    hold();
    pass(0ms);
    const auto renewal = taken(kMotors).at(0);
    answer(renewal, {{"status", "ok"}, {"proof", "renewed"}});
    EXPECT_TRUE(ended_.empty());
    answer(renewal, {{"status", "refused"}, {"reason", "not-held"}});
    answer(renewal, {{"status", "refused"}, {"reason", "not-held"}});
    ASSERT_EQ(ended_.size(), 1u);
    EXPECT_EQ(ended_[0].reason, "not-held");
    pass(1s);
    EXPECT_TRUE(taken(kMotors).empty());
}

TEST_F(HoldTest, ConnectionThatIsLost_GetsNoRenewalsAndGoesOnWhenItIsBack) {
    hold();
    pass(50ms);
    sent.clear();
    lose();
    pass(200ms);
    EXPECT_TRUE(taken(kMotors).empty());
    connect();
    pass(100ms);
    EXPECT_EQ(taken(kMotors).size(), 1u);
}

TEST_F(HoldTest, HandleThatEnded_IsNotRenewed) {
    hold();
    hold_.reset();
    pass(1s);
    EXPECT_TRUE(taken(kMotors).empty());
}

}  // namespace
}  // namespace asip::caller
