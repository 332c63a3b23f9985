// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <thread>

#include "running_registry.hpp"

namespace asip::test {
namespace {

using Kind = bus::ChangeEvent::Kind;

TEST(Registry, BoardAnnouncedBeforeItStarted_IsListedAtOnce) {
    MosquittoBroker broker;
    BusProbe probe(broker.port());
    probe.publish(announcement("uno1", description_text("uno1", "a", 1), 60));
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    const auto answer =
        ask(probe, R"({"find":"services","kind":["distance"],"state":["online"],"count":true})");
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->registry, "r1");
    EXPECT_EQ(answer->total, 1u);
    ASSERT_EQ(answer->services.size(), 1u);
    EXPECT_EQ(answer->services[0].board, "uno1");
    EXPECT_EQ(answer->services[0].title, "A thing");
    EXPECT_TRUE(probe.wait_for("asip/registry/r1/$state", "online"));
    EXPECT_TRUE(probe.wait_for("asip/servicebus/$probe")) << "asks the living to speak up";
}

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

TEST(Registry, WillOfADyingAgent_MakesItsBoardLost) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    BusProbe::Options options;
    options.will =
        mqtt::Message{.topic = "asip/servicebus/uno1/$state", .payload = "lost", .qos = 1, .retain = true};
    BusProbe agent(broker.port(), {}, options);
    agent.publish(announcement("uno1", description_text("uno1", "a", 1), 60));
    ASSERT_TRUE(becomes(probe, "uno1", "online"));
    agent.drop();
    EXPECT_TRUE(becomes(probe, "uno1", "lost"));
    EXPECT_EQ(events_of(probe).back().reason, "agent-gone");
}

TEST(Registry, LeaseRunsOutWithoutAWill_BoardIsLost) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    probe.publish(announcement("uno1", description_text("uno1", "a", 1, 1), 1));
    ASSERT_TRUE(probe.wait_for("asip/registry/r1/events"));
    EXPECT_TRUE(becomes(probe, "uno1", "lost"));
    EXPECT_EQ(events_of(probe).back().reason, "expired");
}

TEST(Registry, GhostOnABrokerWithoutExpiry_ItsDescriptionIsEmptied) {
    MosquittoBroker broker;
    BusProbe::Options old;
    old.v5 = false;
    BusProbe agent(broker.port(), {}, old);
    agent.publish(announcement("uno1", description_text("uno1", "a", 1, 1)));
    RunningRegistry registry(broker.address(), "r1", {"--config", settings_file("mqtt-version = 3.1.1\n")});
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port(), {"#"}, old);
    EXPECT_TRUE(probe.wait_for("asip/servicebus/uno1/$description", ""));
    EXPECT_TRUE(becomes(probe, "uno1", "lost")) << "the board stays listed, marked";
    BusProbe late(broker.port());
    EXPECT_TRUE(late.wait_for("asip/registry/r1/$state", "online"));
    EXPECT_EQ(late.count("asip/servicebus/uno1/$description"), 0u);
}

TEST(Registry, RetainedBoardThatDoesNotAnswerItsProbe_IsNotLostBeforeItsLease) {
    MosquittoBroker broker;
    BusProbe::Options old;
    old.v5 = false;
    BusProbe agent(broker.port(), {}, old);
    agent.publish(announcement("uno1", description_text("uno1", "a", 1, 60)));
    RunningRegistry registry(broker.address(), "r1", {"--config", settings_file("mqtt-version = 3.1.1\n")});
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port(), {"#"}, old);
    ASSERT_TRUE(becomes(probe, "uno1", "online"));
    std::this_thread::sleep_for(13s);  // longer than a reconnection gives, and than the clearing behind it
                                       // takes
    EXPECT_EQ(state_of(probe, "uno1"), "online");
    EXPECT_EQ(probe.count("asip/servicebus/uno1/$description"), 1u) << "it was cleared";
    for (const auto& event : events_of(probe))
        EXPECT_NE(event.reason, "expired");
}

TEST(Registry, BoardWithThePublishedNamesOnly_IsAFullMemberAndItsTrafficRenewsIt) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    probe.publish("asip/servicebus", "esp1");
    probe.publish("asip/servicebus/esp1", "Distance\n");
    ASSERT_TRUE(becomes(probe, "esp1", "online"));
    ASSERT_TRUE(wait_until([&] {
        const auto answer = ask(probe, R"({"find":"services","board":"esp1"})");
        return answer && answer->services.size() == 1 && answer->services[0].name == "Distance";
    }));
    const auto last_seen = [&] { return ask(probe, R"({"find":"boards"})")->boards.at(0).last_seen; };
    const auto before = last_seen();
    EXPECT_TRUE(wait_until([&] {
        probe.publish("asip/esp1/out", "@D,e,1,{42}");
        return last_seen() > before;
    })) << "traffic counts as a sign of life";
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
