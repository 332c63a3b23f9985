// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "running_registry.hpp"

namespace asip::test {
namespace {

using Kind = bus::ChangeEvent::Kind;

// Changes that follow each other faster than the broker takes them become one event.
TEST(Registry, LifeOfABoard_IsReportedAsNumberedEvents) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    const auto has_events = [&](std::size_t count) {
        return wait_until([&] { return events_of(probe).size() == count; });
    };
    probe.publish(announcement("uno1", description_text("uno1", "a", 1), 60));
    ASSERT_TRUE(has_events(1));
    probe.publish("asip/servicebus/uno1/$state", "sleeping", true, 1);
    ASSERT_TRUE(has_events(2));
    probe.publish("asip/servicebus/uno1/$state", "offline", true, 1);
    ASSERT_TRUE(has_events(3));
    const auto events = events_of(probe);
    EXPECT_EQ(events[0].kind, Kind::kAdded);
    EXPECT_EQ(events[0].board.services.size(), 1u);
    EXPECT_EQ(events[1].kind, Kind::kState);
    EXPECT_EQ(events[1].was, "online");
    EXPECT_EQ(events[1].board.state, "sleeping");
    EXPECT_EQ(events[2].board.state, "offline");
    EXPECT_EQ(events[2].reason, "stopped");
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(events[i].seq, i + 1);
}

TEST(Registry, HostileAnnouncements_AreRefusedCountedAndHarmNobody) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address(), "r1", {"--config", settings_file("stats-interval = 1s\n")});
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    probe.publish(announcement("uno1", description_text("uno1", "a", 1), 60));
    ASSERT_TRUE(becomes(probe, "uno1", "online"));
    const std::string deep(5000, '[');
    for (const std::string& payload :
         std::vector<std::string>{std::string("garbage"), std::string("{"), deep,
                                  R"({"board":"uno2","session":"x","seq":9,"services":[]})",
                                  std::string(200'000, 'x'), std::string("\xff\xfe\x00\x01", 4),
                                  R"({"board":"uno1","session":"x","seq":1e99,"services":[]})"}) {
        probe.publish("asip/servicebus/uno1/$description", payload, true, 1);
    }
    probe.publish("asip/servicebus", "a/b");
    probe.publish("asip/servicebus", std::string(10'000, 'n'));
    probe.publish("asip/servicebus/registry/$description", description_text("registry", "a", 1));
    probe.publish("asip/servicebus/a b/$state", "online");
    probe.publish("asip/servicebus/uno1/$state", "undead");
    probe.publish("asip/servicebus/uno1/$nonsense/deeper", "x");
    probe.publish("asip/registry/query", "not a query");
    probe.publish("asip/registry/query", R"({"find":"boards","reply_to":"a/#"})");
    probe.publish("asip/registry/r1/query", std::string(100'000, '{'));
    EXPECT_TRUE(probe.wait_for([](const mqtt::Message& m) {
        return m.topic == "asip/registry/r1/$stats" &&
               m.payload.find("\"wrong-board\":1") != std::string::npos &&
               m.payload.find("\"bad-state\":1") != std::string::npos;
    }));
    EXPECT_EQ(state_of(probe, "uno1"), "online");
    EXPECT_EQ(ask(probe, R"({"find":"boards"})")->boards.size(), 1u);
    EXPECT_TRUE(registry.process().running());
}

TEST(Registry, BadOptions_EndWithStatus2AndWhatToDo) {
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{"--config", settings_file("forget-after = soon\n")},
          {"--id", "a/b"},
          {"--config", settings_file("max-boards = 0\n")},
          {"--nonsense"},
          {"--config", settings_file("history-size = 1\n")}}) {
        std::vector<std::string> arguments{ASIP_REGISTRY_PROGRAM};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const auto finished = run(arguments);
        EXPECT_EQ(finished.status, 2) << more.front();
        EXPECT_NE(finished.errors, "") << more.front();
        EXPECT_EQ(finished.output, "") << more.front();
    }
}

}  // namespace
}  // namespace asip::test
