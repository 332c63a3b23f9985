// SPDX-License-Identifier: Apache-2.0
// asip-load beside a real broker and a real registry.
#include <gmock/gmock.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "running_registry.hpp"

namespace asip::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

struct LoadTest : testing::Test {
    std::vector<std::string> command(std::vector<std::string> more) const {
        more.insert(more.begin(),
                    {ASIP_LOAD_PROGRAM, "--broker", broker.address(), "--log-level", "warning"});
        return more;
    }
    std::unique_ptr<ChildProcess> start(std::vector<std::string> more) const {
        more.insert(more.end(), {"-o", "json", "--watch", "--settle", "60s"});
        return std::make_unique<ChildProcess>(command(std::move(more)));
    }
    /// What it reports when it is ended.
    json report(ChildProcess& load) const {
        load.signal(SIGINT);
        EXPECT_EQ(load.wait_exit(time_limit(30s)), 0) << load.output() << load.errors();
        return json::parse(load.output(), nullptr, false);
    }
    std::size_t count(const std::string& state) {
        BusProbe probe(broker.port(), {"answers"});
        const auto answer = ask(
            probe, R"({"find":"boards","state":")" + state + R"(","board":"load-*","limit":1,"count":true})");
        return answer ? answer->total.value_or(0) : 0;
    }
    /// Boards that the registry has reported as lost, whatever became of them.
    std::size_t were_lost() const {
        std::set<std::string> boards;
        for (const auto& event : events_of(events))
            if (event.board.state == "lost") boards.insert(event.board.board);
        return boards.size();
    }
    bool counts(const std::string& state, std::size_t boards) {
        return wait_until([&] { return count(state) == boards; }, time_limit(20s));
    }

    MosquittoBroker broker;
    RunningRegistry registry{broker.address()};
    BusProbe events{broker.port(), {"asip/registry/r1/events", "asip/reply/#"}};
};

TEST_F(LoadTest, BoardsThatDieFlapLeaveAndJoin_AreSeenAsSuchByTheRegistry) {
    ASSERT_TRUE(registry.complete());
    const auto load = start({"--boards", "200", "--join-rate", "400", "--commands", "100", "--values", "1",
                             "--step", "then die 10", "--step", "then flap 20 down 300ms", "--step",
                             "then leave 5", "--step", "then join 4"});
    EXPECT_TRUE(counts("offline", 5));
    EXPECT_TRUE(counts("lost", 6)) << "4 of the 10 that died joined again";
    EXPECT_TRUE(counts("online", 189));
    EXPECT_TRUE(events.wait_for(
        [](const mqtt::Message& message) {
            return message.payload.find(R"("proof":"simulated")") != std::string::npos;
        },
        time_limit(20s)));
    const auto result = report(*load);
    EXPECT_EQ(result.at("present"), 189);
    EXPECT_EQ(result.at("announced"), 189);
    EXPECT_EQ(result.at("connections"), 200);
    EXPECT_EQ(result.at("flapped"), 20);
    const auto& seen = result.at("registries").at("r1");
    EXPECT_EQ(seen.at("wrong"), 0) << seen;
    EXPECT_GE(seen.at("lost").at("count"), 6);
    EXPECT_GE(seen.at("online").at("count"), 189);
    EXPECT_GE(were_lost(), 30u) << "10 died and 20 flapped: each will fired";
    EXPECT_GT(result.at("commands").at("sent"), 0);
    EXPECT_EQ(result.at("commands").at("refused"), 0);
    EXPECT_GT(result.at("values"), 0);
    EXPECT_TRUE(counts("offline", 189 + 5));
    EXPECT_TRUE(counts("lost", 6));
}

TEST_F(LoadTest, BoardsThatShareConnections_AreTheSameToTheRegistry) {
    ASSERT_TRUE(registry.complete());
    // Where it is too short for a busy machine, boards that live are lost for a moment, too.
    const std::string lease = other_programs() ? "25" : "8";
    const auto load =
        start({"--boards", "200", "--boards-per-connection", "50", "--join-rate", "400", "--lease", lease,
               "--step", "then die 10", "--step", "then flap 20 down 2s", "--step", "then hang 6"});
    EXPECT_TRUE(wait_until([&] { return were_lost() >= 36; }, time_limit(10s)))
        << were_lost() << " of 10 by a will, 20 for a moment, 6 by their leases";
    EXPECT_TRUE(counts("lost", 16));
    EXPECT_TRUE(counts("online", 184));
    const auto result = report(*load);
    EXPECT_EQ(result.at("connections"), 4);
    EXPECT_EQ(result.at("connections_made"), 4 + result.at("connections_lost").get<int>());
    EXPECT_EQ(result.at("announced"), 184);
    const auto& seen = result.at("registries").at("r1");
    EXPECT_EQ(seen.at("wrong"), 0) << seen;
    EXPECT_GE(seen.at("lost").at("count"), 10)
        << "by their wills; of the 20 some may be back before anybody sees it";
    EXPECT_TRUE(counts("offline", 184));
    EXPECT_TRUE(counts("lost", 16));
}

TEST_F(LoadTest, ListOfBrokers_EachHasAShareOfTheBoards) {
    const MosquittoBroker other;
    BusProbe heard(other.port(), {"asip/servicebus/#"});
    ChildProcess load(
        {ASIP_LOAD_PROGRAM, "--broker", broker.address() + "," + other.address(), "--boards", "2"});
    const auto comes = [](BusProbe& probe, const std::string& board) {
        return probe.wait_for(
            [&](const mqtt::Message& message) {
                return message.topic == "asip/servicebus/" + board + "/$state";
            },
            time_limit(60s));
    };
    BusProbe here(broker.port(), {"asip/servicebus/#"});
    EXPECT_TRUE(comes(here, "load-000000"));
    EXPECT_TRUE(comes(heard, "load-000001"));
    load.signal(SIGINT);
    EXPECT_EQ(load.wait_exit(time_limit(60s)), 0) << load.errors();
}

TEST_F(LoadTest, LabelOfABoard_IsTakenAndSeenByTheRegistry) {
    ASSERT_TRUE(registry.complete());
    ChildProcess load(command({"--boards", "2"}));
    ASSERT_TRUE(counts("online", 2));
    BusProbe probe(broker.port(), {"answers", "asip/reply/#"});
    const auto answer = probe.request("asip/load-000001/in", R"({"labels":{"room":"lab"}})", time_limit(60s));
    ASSERT_TRUE(answer);
    EXPECT_EQ(json::parse(*answer).at("status"), "ok") << *answer;
    EXPECT_TRUE(wait_until(
        [&] {
            const auto found = ask(probe, R"({"find":"boards","labels":"room=lab"})");
            return found && found->boards.size() == 1 && found->boards[0].board == "load-000001";
        },
        time_limit(60s)));
    const auto refused =
        probe.request("asip/load-000000/in", R"({"labels":{"a room":"lab"}})", time_limit(60s));
    ASSERT_TRUE(refused);
    EXPECT_EQ(json::parse(*refused).at("status"), "refused") << *refused;
    load.signal(SIGINT);
    EXPECT_EQ(load.wait_exit(time_limit(60s)), 0) << load.errors();
}

TEST_F(LoadTest, QuestionsAndWatchers_ShowWhatTheRegistriesBear) {
    RunningRegistry other(broker.address(), "r2");
    ASSERT_TRUE(registry.complete());
    ASSERT_TRUE(other.complete());
    const auto load = start({"--boards", "60", "--join-rate", "100", "--queries", "50", "--watchers", "8",
                             "--step", "then flap 6 down 1s"});
    ASSERT_TRUE(wait_until([&] { return were_lost() >= 6; }, time_limit(20s)));
    ASSERT_TRUE(counts("online", 60));
    const auto result = report(*load);
    std::uint64_t asked = 0;
    for (const auto& [name, kind] : result.at("queries").at("kinds").items()) {
        asked += kind.at("asked").get<std::uint64_t>();
        EXPECT_GT(kind.at("asked"), 0) << name;
        EXPECT_GT(kind.at("answered"), 0) << name;
        EXPECT_EQ(kind.at("answered").get<int>() + kind.at("unanswered").get<int>(), kind.at("asked"))
            << name;
        EXPECT_EQ(kind.at("took").at("count"), kind.at("answered")) << name;
        EXPECT_EQ(kind.at("refused"), 0) << name;
        EXPECT_EQ(kind.at("wrong"), 0) << name;
    }
    EXPECT_GT(asked, 50u);
    const auto& watchers = result.at("watchers");
    EXPECT_EQ(watchers.at("listening"), 8);
    for (const char* id : {"r1", "r2"}) {
        const auto& seen = watchers.at("registries").at(id);
        EXPECT_GE(seen.at("different"), 6) << id;
        EXPECT_GE(seen.at("events"), seen.at("different")) << id;
        EXPECT_LE(seen.at("events"), 8 * seen.at("different").get<int>()) << id;
        EXPECT_EQ(seen.at("left_out"), 0) << id;
        EXPECT_EQ(seen.at("resets"), 0) << id;
        EXPECT_GE(seen.at("first").at("count"), 1) << id << ": of changes that still hold when they are seen";
        EXPECT_EQ(seen.at("last").at("count"), seen.at("first").at("count")) << id;
        EXPECT_LE(seen.at("first").at("p50_ms"), seen.at("last").at("p50_ms")) << id;
    }
}

TEST_F(LoadTest, SilentRegistry_LeavesQuestionsUnanswered) {
    ASSERT_TRUE(registry.complete());
    ChildProcess load(command({"--boards", "5", "--queries", "50", "-o", "json"}));
    ASSERT_TRUE(counts("online", 5));
    registry.process().signal(SIGSTOP);
    std::this_thread::sleep_for(2s);
    load.signal(SIGINT);
    load.wait_exit(time_limit(30s));
    registry.process().signal(SIGCONT);
    const auto kind = json::parse(load.output()).at("queries").at("kinds").at("board");
    EXPECT_GE(kind.at("unanswered"), 10) << load.output();
    EXPECT_EQ(kind.at("answered").get<int>() + kind.at("unanswered").get<int>(), kind.at("asked"));
}

TEST_F(LoadTest, Killed_ItsWillsAreFired) {
    ASSERT_TRUE(registry.complete());
    ChildProcess load(command({"--boards", "50"}));
    ASSERT_TRUE(counts("online", 50));
    load.signal(SIGKILL);
    EXPECT_TRUE(counts("lost", 50));
}

TEST_F(LoadTest, Signalled_SaysGoodbyeAndReports) {
    ASSERT_TRUE(registry.complete());
    ChildProcess load(command({"--boards", "20"}));
    ASSERT_TRUE(counts("online", 20));
    load.signal(SIGINT);
    EXPECT_EQ(load.wait_exit(), 0);
    EXPECT_THAT(load.output(), HasSubstr("20 present, 20 announced"));
    EXPECT_TRUE(counts("offline", 20));
}

TEST_F(LoadTest, NamesOfOthers_AreLeftToThem) {
    ASSERT_TRUE(registry.complete());
    ChildProcess first(command({"--boards", "5"}));
    ASSERT_TRUE(counts("online", 5));
    const auto second = run(command({"--boards", "7", "--time", "3s"}), {}, time_limit(30s));
    EXPECT_EQ(second.status, 6);
    EXPECT_THAT(second.output, HasSubstr("5 boards: take another --prefix"));
    EXPECT_TRUE(first.running());
    EXPECT_EQ(count("online"), 5u);
}

TEST_F(LoadTest, BrokerRestarted_AllComeBack) {
    ASSERT_TRUE(registry.complete());
    ChildProcess load(command({"--boards", "30", "--watch"}));
    ASSERT_TRUE(counts("online", 30));
    broker.restart();
    ASSERT_TRUE(wait_until([&] {
        const auto log = registry.process().errors();
        return log.find("catalogue is complete") != log.rfind("catalogue is complete");
    }));
    ASSERT_TRUE(counts("online", 30));
    load.signal(SIGINT);
    EXPECT_EQ(load.wait_exit(), 0) << load.output();
}

TEST(LoadWithoutBroker, NoRegistryToWatch_IsNoSuccess) {
    MosquittoBroker broker;
    const auto done =
        run({ASIP_LOAD_PROGRAM, "--broker", broker.address(), "--boards", "3", "--time", "3s", "--watch"});
    EXPECT_EQ(done.status, 1);
    EXPECT_THAT(done.output, HasSubstr("none was there"));
}

TEST(LoadWithoutBroker, RegistryThatListsNothing_IsWrong) {
    MosquittoBroker broker;
    BusProbe liar(broker.port(), {"asip/registry/query"});
    ChildProcess load({ASIP_LOAD_PROGRAM, "--broker", broker.address(), "--boards", "3", "--queries", "40",
                       "--time", "13s", "-o", "json"});
    std::size_t answered = 0;
    while (load.running()) {
        const auto questions = liar.messages();
        for (; answered < questions.size(); ++answered) {
            mqtt::Message answer;
            answer.topic = questions[answered].response_topic;
            answer.correlation = questions[answered].correlation;
            answer.payload = R"({"registry":"liar","epoch":"1","seq":1,"find":"boards","items":[]})";
            liar.publish(answer);
        }
        std::this_thread::sleep_for(20ms);
    }
    EXPECT_EQ(load.wait_exit(), 1);
    const auto kinds = json::parse(load.output()).at("queries").at("kinds");
    EXPECT_GE(kinds.at("board").at("wrong"), 10) << "of those that were announced ten seconds before";
    EXPECT_LT(kinds.at("board").at("wrong"), kinds.at("board").at("answered"));
    EXPECT_EQ(kinds.at("board").at("unanswered"), 0);
    EXPECT_GE(kinds.at("description").at("wrong"), 1);
    EXPECT_EQ(kinds.at("list").at("wrong"), 0) << "of a page it is not judged";
}

TEST(LoadWithoutBroker, RefusedByTheBroker_EndsAndSaysSo) {
    MosquittoBroker broker(MosquittoBroker::Options{.users = {{"u", "p"}}});
    const auto done = run({ASIP_LOAD_PROGRAM, "--broker", broker.address(), "--boards", "3"});
    EXPECT_EQ(done.status, 3);
    EXPECT_THAT(done.errors, HasSubstr("user"));
}

}  // namespace
}  // namespace asip::test
