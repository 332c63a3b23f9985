// SPDX-License-Identifier: Apache-2.0
#include "agent/program/stop_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/mqtt/scripted_broker.hpp"

namespace asip::test {
namespace {

using testing::Contains;
using testing::Each;

mqtt::Message answer_to(const std::string& user, std::size_t bytes = 2) {
    return {.topic = "asip/reply/" + user + "/desk/c", .payload = std::string(bytes, '.'), .qos = 1};
}

/// The broker acknowledges nothing unasked.
class AgentStopLine : public testing::Test {
  protected:
    AgentStopLine() {
        bool heard = false;
        listening = line.listen("asip/desk/$stop", {[](const mqtt::Message&) {},
                                                    [&](bool now, const std::string&) { heard = now; }});
        EXPECT_TRUE(until([&] { return heard; }));
    }
    static mqtt::Options options(const ScriptedBroker& broker) {
        mqtt::Options made;
        made.brokers = {{"127.0.0.1", broker.port(), false}};
        return made;
    }
    template <class Condition>
    bool until(Condition condition) {
        return run_until(io, [&] { return broker.run(), condition(); });
    }

    boost::asio::io_context io;
    ScriptedBroker broker;
    agent::StopLine line{io, options(broker)};
    agent::StopLine::Listening listening;
};

TEST_F(AgentStopLine, AnswersToAFloodWait_AnotherUsersIsNext) {
    for (int i = 0; i < 100; ++i)
        line.answer(answer_to("olga"));
    ASSERT_TRUE(until([&] { return broker.published.size() == 8; }));
    line.answer(answer_to("ann"));
    EXPECT_THAT(broker.published, Each(answer_to("olga").topic));
    broker.acknowledge(2);
    ASSERT_TRUE(until([&] { return broker.published.size() == 10; }));
    EXPECT_THAT(broker.published, Contains(answer_to("ann").topic));
}

TEST_F(AgentStopLine, AnswersToCommands_HaveRoomWhileFewAreUnderWay) {
    EXPECT_TRUE(line.has_room_for(answer_to("ann", 4096)));
    EXPECT_FALSE(line.has_room_for(answer_to("ann", 4097)));
    line.answer(answer_to("ann"));
    EXPECT_TRUE(line.has_room_for(answer_to("ann")));
    line.answer(answer_to("ann"));
    EXPECT_FALSE(line.has_room_for(answer_to("ann")));
    ASSERT_TRUE(until([&] { return broker.published.size() == 2; }));
    broker.acknowledge(1);
    EXPECT_TRUE(until([&] { return line.has_room_for(answer_to("ann")); }));
}

}  // namespace
}  // namespace asip::test
