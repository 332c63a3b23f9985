// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "asip/model/model_set.hpp"
#include "running_registry.hpp"
#include "tests/support/tcp_relay.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

/// board0 to board1999; true once the registry has the last of them.
bool announce_2000(MosquittoBroker& broker, BusProbe& probe) {
    BusProbe boards(broker.port(), {"nothing"});
    for (int i = 0; i < 2000; ++i) {
        const std::string board = "board" + std::to_string(i);
        boards.publish(announcement(board, description_text(board, "a", 1), 600));
    }
    return becomes(probe, "board1999", "online");
}

TEST(Registry, ForgottenBoard_LeavesNoRetainedTopicBehind) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    probe.publish(announcement("uno1", description_text("uno1", "a", 1)));
    probe.publish("asip/servicebus/uno1", "Distance", true, 1);
    probe.publish("asip/uno1/distance/out", R"({"distance":[42]})", true, 1);
    probe.publish("asip/uno1/in", "I,d,13,1", true, 1);
    probe.publish("asip/uno2/in", "not mine", true, 1);
    ASSERT_TRUE(becomes(probe, "uno1", "online"));
    EXPECT_EQ(ask(probe, R"({"forget":"uno1"})")->refused, "alive");
    probe.publish("asip/servicebus/uno1/$state", "offline", true, 1);
    ASSERT_TRUE(becomes(probe, "uno1", "offline"));
    EXPECT_THAT(ask(probe, R"({"forget":"uno*","dry_run":true})")->forgotten, testing::ElementsAre("uno1"));
    EXPECT_EQ(state_of(probe, "uno1"), "offline");
    EXPECT_THAT(ask(probe, R"({"forget":"uno1"})")->forgotten, testing::ElementsAre("uno1"));
    for (const char* topic : {"asip/servicebus/uno1/$description", "asip/servicebus/uno1/$state",
                              "asip/servicebus/uno1", "asip/uno1/distance/out", "asip/uno1/in"}) {
        EXPECT_TRUE(probe.wait_for(topic, "")) << topic;
    }
    EXPECT_EQ(state_of(probe, "uno1"), "unknown");
    BusProbe late(broker.port());
    ASSERT_TRUE(late.wait_for("asip/uno2/in"));
    ASSERT_TRUE(late.wait_for("asip/registry/r1/$state"));
    for (const auto& message : late.messages())
        EXPECT_EQ(message.topic.find("uno1"), std::string::npos) << message.topic;
}

TEST(Registry, BesideMoreJunkThanItsQueueHolds_IsCompleteWhenItSaysSo) {
    MosquittoBroker broker{{.extra_lines = {"max_queued_bytes 1000000"}}};
    BusProbe probe(broker.port(), {"nothing"});
    const auto junk = [&](int begin) {
        for (int i = begin; i < begin + 40; ++i)
            probe.publish("asip/servicebus/board" + std::to_string(i) + "/$demand/eve/c",
                          std::string(50'000, 'x'), true);
    };
    junk(0);
    for (int i = 0; i < 80; ++i) {
        const std::string board = "board" + std::to_string(i);
        probe.publish(announcement(board, description_text(board, "a", 1), 600));
    }
    junk(40);
    ASSERT_TRUE(wait_until([&] { return probe.all_acknowledged(); }));
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.process().wait_for_errors("catalogue is complete.*boards=80"))
        << registry.process().errors();
}

TEST(Registry, FloodOfQuestions_OthersAreAnsweredInTime_AndTheConnectionStays) {
    MosquittoBroker broker{{.extra_lines = {"max_queued_messages 0"}}};
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port(), {"nothing"});
    ASSERT_TRUE(announce_2000(broker, probe));
    BusProbe flood(broker.port(), {"asip/reply/eve/#"});
    for (int i = 0; i < 20'000; ++i)
        flood.publish("asip/registry/query",
                      R"({"find":"boards","limit":1000,"reply_to":"asip/reply/eve/registry/)" +
                          std::to_string(i % 9) + R"("})");
    const auto began = std::chrono::steady_clock::now();
    ASSERT_TRUE(ask(probe, R"({"find":"boards","limit":1})")) << registry.process().errors();
    EXPECT_LT(std::chrono::steady_clock::now() - began, time_limit(std::chrono::seconds(5)));
    EXPECT_TRUE(flood.wait_for(
        [](const mqtt::Message& answer) { return answer.payload.find("queue-full") != std::string::npos; }));
    EXPECT_EQ(registry.process().errors().find("connection lost"), std::string::npos);
}

TEST(Registry, QuestionsAreNotHeard_IsNotOnlineUntilTheyAre) {
    MosquittoBroker broker;
    TcpRelay relay(broker.port());
    relay.cut([](std::string_view first) { return first.find("-answers") != std::string_view::npos; });
    BusProbe probe(broker.port(), {"asip/registry/r1/$state"});
    RunningRegistry registry("127.0.0.1:" + std::to_string(relay.port()));
    ASSERT_TRUE(registry.complete());
    EXPECT_EQ(probe.count("asip/registry/r1/$state"), 0u);
    relay.restore();
    EXPECT_TRUE(probe.wait_for("asip/registry/r1/$state", "online", 60s)) << registry.process().errors();
    EXPECT_TRUE(ask(probe, R"({"find":"boards","limit":1})")) << registry.process().errors();
}

// A broker that takes no packet as long as that drops it for this connection alone.
TEST(Registry, FloodOfLongQuestions_DelaysNoOther) {
    MosquittoBroker broker{{.extra_lines = {"max_queued_messages 0", "max_queued_bytes 4000000"}}};
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port(), {"nothing"});
    const std::string question = R"({"find":"boards","limit":1})";
    ASSERT_TRUE(ask(probe, question)) << registry.process().errors();
    registry.process().signal(SIGSTOP);
    for (int i = 0; i < 300; ++i)
        probe.publish("asip/registry/query", std::string(200'000, 'x'));
    probe.publish("asip/registry/query", R"({"find":"boards","limit":1,"reply_to":"nothing"})");
    ASSERT_TRUE(wait_until([&] { return probe.all_acknowledged(); }, 60s));
    registry.process().signal(SIGCONT);
    EXPECT_TRUE(probe.wait_for("nothing")) << registry.process().errors();
}

TEST(Registry, ConnectionIsAway_NoAnswerOfMegabytesIsDropped) {
    MosquittoBroker broker{{.extra_lines = {"max_queued_messages 0"}}};
    TcpRelay relay(broker.port());
    RunningRegistry registry("127.0.0.1:" + std::to_string(relay.port()));
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port(), {"nothing"});
    ASSERT_TRUE(announce_2000(broker, probe));
    constexpr int kAskers = 10, kQuestions = 30;
    BusProbe askers(broker.port(), {"asip/reply/#"});
    registry.process().signal(SIGSTOP);
    for (int i = 0; i < kAskers * kQuestions; ++i)
        askers.publish("asip/registry/query", R"({"find":"boards","limit":1000,"reply_to":"asip/reply/user)" +
                                                  std::to_string(i % kAskers) + R"(/registry/c"})");
    ASSERT_TRUE(wait_until([&] { return askers.all_acknowledged(); }));
    registry.process().signal(SIGCONT);
    ASSERT_TRUE(askers.wait_for([](const mqtt::Message&) { return true; }));
    relay.cut();
    auto used = registry.process().processor_time();
    ASSERT_TRUE(wait_until([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        return registry.process().processor_time() -
                   std::exchange(used, registry.process().processor_time()) <
               std::chrono::milliseconds(100);
    }));
    relay.restore();
    EXPECT_TRUE(wait_until([&] { return askers.messages().size() == kAskers * kQuestions; }))
        << askers.messages().size() << registry.process().errors();
}

TEST(Registry, Flood_NothingIsLostAndQueriesAreStillAnswered) {
    MosquittoBroker broker{{.extra_lines = {"max_queued_messages 0"}}};  // as in the configuration that is
                                                                         // shipped
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe flood(broker.port(), {"nothing"});
    BusProbe probe(broker.port(), {"nothing"});
    for (int i = 0; i < 20'000; ++i) {
        const std::string board = "board" + std::to_string(i % 2000);
        flood.publish(announcement(board, description_text(board, "a", i + 1), 60));
        if (i % 5000 == 4999) {
            EXPECT_TRUE(ask(probe, R"({"find":"boards","limit":1})")) << registry.process().errors();
        }
    }
    EXPECT_TRUE(wait_until([&] {
        const auto answer = ask(probe, R"({"find":"boards","state":["online"],"limit":1})");
        return answer && answer->total == 2000u;
    }));
    EXPECT_TRUE(wait_until([&] {
        const auto answer = ask(probe, R"({"find":"boards","board":"board1999"})");
        return answer && answer->boards.at(0).seq == 20'000u;
    }));
}

TEST(Registry, History_HoldsWhatHappenedAlsoAfterARestart) {
    MosquittoBroker broker;
    TempDir folder;
    const std::string file = folder.file("history.db");
    BusProbe probe(broker.port());
    {
        RunningRegistry registry(broker.address(), "r1", {"--history", file});
        ASSERT_TRUE(registry.complete());
        probe.publish(announcement("uno1", description_text("uno1", "a", 1), 60));
        probe.publish("asip/servicebus/uno1/$state", "offline", true, 1);
        ASSERT_TRUE(becomes(probe, "uno1", "offline"));
        registry.process().signal(15);
        EXPECT_EQ(registry.process().wait_exit(), 0);
    }
    EXPECT_EQ(probe.last("asip/registry/r1/$state"), "offline") << "said goodbye";
    RunningRegistry registry(broker.address(), "r1", {"--history", file});
    ASSERT_TRUE(registry.complete());
    const auto answer = ask(probe, R"({"find":"history","board":"uno1"})");
    ASSERT_TRUE(answer);
    ASSERT_GE(answer->history.size(), 2u);
    const auto& first = answer->history.back();
    EXPECT_EQ(first.what, "added");
    EXPECT_EQ(first.state, "online");
    EXPECT_EQ(answer->history[answer->history.size() - 2].was, "online");
}

}  // namespace
}  // namespace asip::test
