// SPDX-License-Identifier: Apache-2.0
// What a command waits for ends with the command: late messages reach no handler.
#include <gtest/gtest.h>

#include <sstream>

#include "cli/ask/bus_session.hpp"
#include "cli/ask/retained.hpp"
#include "cli/secure/leftovers.hpp"
#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {
namespace {

class SessionTest : public testing::Test {
  protected:
    SessionTest() {
        environment_.mqtt.brokers = {*mqtt::parse_broker(broker_.url())};
        environment_.mqtt.user = "ada";
        session_.emplace(environment_);
    }

    MosquittoBroker broker_;
    BusProbe probe_{broker_.port()};
    std::stringstream in_, out_, err_;
    cli::Environment environment_{in_, out_, err_};
    std::optional<cli::BusSession> session_;
};

/// A broker drops what is beyond the queue of a reader, and our own queue takes only so many.
TEST(ClearAllRetained, MoreThanAQueueHolds_LeavesNothing_AndNothingOfOthersIsCleared) {
    MosquittoBroker broker({.extra_lines = {"max_queued_bytes 1000000"}});
    BusProbe probe(broker.port(), {"nothing"});
    for (int i = 0; i < 60; ++i)
        probe.publish("asip/servicebus/uno" + std::to_string(i) + "/$demand/eve/c", std::string(100'000, 'x'),
                      true);
    for (int i = 0; i < 12'000; ++i)
        probe.publish("asip/reply/eve/" + std::to_string(i), "x", true);
    probe.publish("asip/servicebus/uno1/$demand/ann/c", "x", true);
    ASSERT_TRUE(wait_until([&] { return probe.all_acknowledged(); }));
    std::stringstream in, out, err;
    cli::Environment environment{in, out, err};
    environment.mqtt.brokers = {*mqtt::parse_broker(broker.url())};
    cli::BusSession session(environment);
    ASSERT_TRUE(session.connect());
    const auto cleared =
        cli::clear_all_retained(environment, session, cli::filters_of(environment.topics, "eve"));
    ASSERT_TRUE(cleared) << cleared.error().text;
    EXPECT_EQ(*cleared, 12'060U);
    BusProbe late(broker.port(), {"asip/servicebus/#"});
    ASSERT_TRUE(late.wait_for("asip/servicebus/uno1/$demand/ann/c"));
    BusProbe answers(broker.port(), {"asip/reply/#"});
    answers.publish("asip/reply/end", "x");
    ASSERT_TRUE(answers.wait_for("asip/reply/end"));
    EXPECT_EQ(answers.messages().size(), 1U);
    for (const auto& message : late.messages())
        EXPECT_EQ(message.topic.find("eve"), std::string::npos) << message.topic;
}

TEST_F(SessionTest, RetainedMessagesThatTakeLongerThanThePatience_AreAllRead) {
    for (int i = 0; i < 40; ++i)
        probe_.publish("kept/" + std::to_string(i), std::string(100'000, 'x'), true);
    ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    ASSERT_TRUE(session_->connect());
    int heard = 0;
    const auto subscription = session_->subscribe("kept/+", [&heard](const mqtt::Message&) {
        std::this_thread::sleep_for(20ms);
        ++heard;
    });
    session_->wait_retained([] { return false; }, 300ms);
    EXPECT_EQ(heard, 40);
}

}  // namespace
}  // namespace asip::test
