// asip-registry as a program beside a real broker: announcements in, answers, events and tidy topics out.
#include <gmock/gmock.h>

#include <set>

#include "asip/bus/catalogue_view.hpp"
#include "running_registry.hpp"
#include "tests/support/temp_dir.hpp"

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

TEST(Registry, LifeOfABoard_IsToldAsNumberedEvents) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    probe.publish(announcement("uno1", description_text("uno1", "a", 1), 60));
    ASSERT_TRUE(becomes(probe, "uno1", "online"));
    probe.publish("asip/servicebus/uno1/$state", "sleeping", true, 1);
    ASSERT_TRUE(becomes(probe, "uno1", "sleeping"));
    probe.publish("asip/servicebus/uno1/$state", "offline", true, 1);
    ASSERT_TRUE(becomes(probe, "uno1", "offline"));
    ASSERT_TRUE(wait_until([&] { return events_of(probe).size() == 3; }));
    const auto events = events_of(probe);
    EXPECT_EQ(events[0].kind, Kind::kAdded);
    EXPECT_EQ(events[0].board.services.size(), 1u);
    EXPECT_EQ(events[1].kind, Kind::kState);
    EXPECT_EQ(events[1].was, "online");
    EXPECT_EQ(events[1].board.state, "sleeping");
    EXPECT_EQ(events[2].board.state, "offline");
    EXPECT_EQ(events[2].reason, "reported");
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
    EXPECT_EQ(events_of(probe).back().reason, "will");
}

TEST(Registry, LeaseRunsOutWithoutAWill_BoardIsLost) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    probe.publish(announcement("uno1", description_text("uno1", "a", 1, 1), 1));
    ASSERT_TRUE(probe.wait_for("asip/registry/r1/events"));
    EXPECT_TRUE(becomes(probe, "uno1", "lost"));
    EXPECT_EQ(events_of(probe).back().reason, "lease");
}

TEST(Registry, GhostOnABrokerWithoutExpiry_ItsDescriptionIsEmptied) {
    MosquittoBroker broker;
    BusProbe::Options old;
    old.v5 = false;
    BusProbe agent(broker.port(), {}, old);
    agent.publish(announcement("uno1", description_text("uno1", "a", 1, 1)));
    RunningRegistry registry(broker.address(), "r1", {"--mqtt-version", "3.1.1"});
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port(), {"#"}, old);
    EXPECT_TRUE(probe.wait_for("asip/servicebus/uno1/$description", ""));
    EXPECT_TRUE(becomes(probe, "uno1", "lost")) << "the board stays listed, marked";
    BusProbe late(broker.port());
    EXPECT_TRUE(late.wait_for("asip/registry/r1/$state", "online"));
    EXPECT_EQ(late.count("asip/servicebus/uno1/$description"), 0u);
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
    RunningRegistry registry(broker.address(), "r1", {"--stats-interval", "1s"});
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

TEST(Registry, BadQuery_IsAnsweredWithAReason) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    for (const char* query :
         {R"({"find":"shoes"})", R"({"find":"boards","limit":-1})", "{}", R"({"find":"boards","sort":"x"})",
          R"({"find":"boards","state":["undead"]})", R"({"find":"boards","cursor":"x"})"}) {
        const auto answer = ask(probe, query);
        ASSERT_TRUE(answer) << query;
        EXPECT_EQ(answer->refused, "invalid") << query;
        EXPECT_NE(answer->error, "") << query;
    }
    EXPECT_EQ(ask(probe, R"({"forget":"nobody"})")->refused, "unknown-board");
    EXPECT_EQ(ask(probe, R"({"find":"history"})")->refused, "no-history");
}

TEST(Registry, QueryOverMqtt311_IsAnsweredByReplyToAndId) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe::Options old;
    old.v5 = false;
    BusProbe probe(broker.port(), {"#"}, old);
    probe.publish("asip/registry/query", R"({"find":"boards","reply_to":"answers/here","id":"77"})");
    const auto message = probe.wait_for("answers/here");
    ASSERT_TRUE(message);
    EXPECT_EQ(bus::parse_answer(message->payload)->id, "77");
}

TEST(Registry, PagesOfAQuery_HoldEachBoardOnce) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port(), {"nothing"});
    for (int i = 0; i < 250; ++i) {
        const std::string board = "board" + std::to_string(i);
        probe.publish(announcement(board, description_text(board, "a", 1), 60));
    }
    ASSERT_TRUE(becomes(probe, "board249", "online"));
    std::set<std::string> seen;
    std::string cursor;
    int pages = 0;
    do {
        const auto answer =
            ask(probe, R"({"find":"services","kind":"distance","limit":40,"cursor":")" + cursor + "\"}");
        ASSERT_TRUE(answer);
        for (const auto& item : answer->services)
            EXPECT_TRUE(seen.insert(item.board).second) << item.board;
        cursor = answer->cursor;
        ++pages;
    } while (!cursor.empty() && pages < 20);
    EXPECT_EQ(seen.size(), 250u);
    EXPECT_EQ(pages, 7);
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

TEST(Registry, BrokerGoneAndBack_CatalogueIsKeptAndCheckedByProbe) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    {
        BusProbe probe(broker.port());
        probe.publish(announcement("alive", description_text("alive", "a", 1, 5), 5));
        probe.publish(announcement("gone", description_text("gone", "a", 1, 5), 5));
        ASSERT_TRUE(becomes(probe, "gone", "online"));
    }
    broker.restart();  // without persistence: it remembers nothing
    ASSERT_TRUE(registry.process().wait_for_errors("connection lost"));
    ASSERT_TRUE(wait_until([&] {
        const auto log = registry.process().errors();
        return log.find("catalogue is complete", log.find("connection lost")) != std::string::npos;
    }));
    BusProbe probe(broker.port());
    EXPECT_EQ(state_of(probe, "gone"), "online") << "kept, until it had time to answer";
    probe.publish(announcement("alive", description_text("alive", "a", 2), 60));
    EXPECT_TRUE(becomes(probe, "gone", "lost"));
    EXPECT_EQ(state_of(probe, "alive"), "online");
}

TEST(Registry, TwoRegistries_AgreeAndTheDeathOfOneHarmsNobody) {
    MosquittoBroker broker;
    RunningRegistry first(broker.address(), "r1");
    auto second = std::make_unique<RunningRegistry>(broker.address(), "r2");
    ASSERT_TRUE(first.complete());
    ASSERT_TRUE(second->complete());
    BusProbe probe(broker.port());
    for (int i = 0; i < 20; ++i) {
        const std::string board = "board" + std::to_string(i);
        probe.publish(announcement(board, description_text(board, "a", 1), 60));
        if (i % 3 == 0) probe.publish("asip/servicebus/" + board + "/$state", "offline", true, 1);
    }
    const auto snapshot = [&](const std::string& registry) {
        std::string text;
        if (const auto answer = ask(probe, R"({"find":"boards"})", registry)) {
            for (const auto& item : answer->boards)
                text += item.board + " " + item.state + " " + item.session + "\n";
        }
        return text;
    };
    ASSERT_TRUE(becomes(probe, "board18", "offline", "r1"));
    ASSERT_TRUE(becomes(probe, "board19", "online", "r2"));
    EXPECT_TRUE(wait_until([&] { return snapshot("r1") == snapshot("r2"); }));
    second->process().signal(9);
    EXPECT_TRUE(probe.wait_for("asip/registry/r2/$state", "lost"));
    EXPECT_EQ(state_of(probe, "board19", "r1"), "online");
    RunningRegistry third(broker.address(), "r3");
    ASSERT_TRUE(third.complete());
    EXPECT_TRUE(wait_until([&] { return snapshot("r1") == snapshot("r3"); })) << "rebuilt from the bus alone";
}

TEST(Registry, TwoAgentsWithOneName_ConflictIsReportedAndTheyNeverAlternate) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe probe(broker.port());
    for (int seq = 1; seq < 6; ++seq) {
        probe.publish(announcement("uno1", description_text("uno1", "aaaa", seq), 60));
        probe.publish(announcement("uno1", description_text("uno1", "bbbb", seq), 60));
    }
    ASSERT_TRUE(wait_until([&] {
        const auto answer = ask(probe, R"({"find":"boards"})");
        return answer && answer->boards.size() == 1 && answer->boards[0].conflict;
    }));
    const auto item = ask(probe, R"({"find":"boards"})")->boards.at(0);
    EXPECT_EQ(item.conflict->holder, "bbbb");
    EXPECT_EQ(item.conflict->other, "aaaa");
    int conflicts = 0;
    for (const auto& event : events_of(probe))
        conflicts += event.kind == Kind::kConflict ? 1 : 0;
    EXPECT_EQ(conflicts, 1);
}

TEST(Registry, WatcherThatJoinsDuringAFlood_EndsWithTheSameBoards) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe flood(broker.port(), {"nothing"});
    BusProbe watcher(broker.port(), {"asip/registry/+/events"});
    std::size_t told = 0;
    bus::CatalogueView view([&](const bus::CatalogueView::Change&) { ++told; });
    std::size_t fed = 0;
    const auto feed = [&] {
        const auto messages = watcher.messages("asip/registry/r1/events");
        for (; fed < messages.size(); ++fed) {
            if (auto event = bus::parse_change_event(messages[fed].payload)) view.event(*event);
        }
    };
    const auto change = [&](int i) {
        const std::string board = "board" + std::to_string(i % 150);
        if (i % 7 == 3) {
            flood.publish("asip/servicebus/" + board + "/$state", i % 2 == 0 ? "offline" : "online", true, 1);
        } else {
            flood.publish(announcement(
                board, description_text(board, "a", i + 1, 60, i % 2 == 0 ? "distance" : "servo"), 60));
        }
    };
    int sent = 0;
    for (; sent < 400; ++sent)
        change(sent);
    // Pages are small, so that the flood goes on between them.
    for (int turn = 0; turn < 200 && view.needs_snapshot(); ++turn) {
        for (const int end = sent + 20; sent < end; ++sent)
            change(sent);
        feed();
        auto query = view.next_query();
        if (!query) break;
        query->limit = 20;
        const auto text = watcher.request("asip/registry/r1/query", bus::encode({*query, "", ""}));
        ASSERT_TRUE(text);
        view.page(*bus::parse_answer(*text));
    }
    ASSERT_TRUE(view.complete());
    for (const int end = sent + 300; sent < end; ++sent)
        change(sent);
    flood.publish(announcement("last", description_text("last", "a", 1), 60));
    ASSERT_TRUE(wait_until([&] {
        feed();
        return view.boards().count("last") == 1;
    }));
    ASSERT_TRUE(view.complete()) << "no event was lost";
    const auto answer = ask(watcher, R"({"find":"boards","limit":1000})");
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->boards.size(), view.boards().size());
    for (const auto& item : answer->boards) {
        const auto copy = view.boards().find(item.board);
        ASSERT_NE(copy, view.boards().end()) << item.board;
        EXPECT_EQ(copy->second.state, item.state) << item.board;
        ASSERT_EQ(copy->second.services.size(), item.services.size());
        EXPECT_EQ(copy->second.services[0].name, item.services[0].name) << item.board;
    }
    EXPECT_GT(told, 150u);
}

TEST(Registry, Flood_NothingIsLostAndQueriesAreStillAnswered) {
    MosquittoBroker broker;
    RunningRegistry registry(broker.address());
    ASSERT_TRUE(registry.complete());
    BusProbe flood(broker.port(), {"nothing"});
    BusProbe probe(broker.port(), {"nothing"});
    for (int i = 0; i < 20'000; ++i) {
        const std::string board = "board" + std::to_string(i % 2000);
        flood.publish(announcement(board, description_text(board, "a", i + 1), 60));
        if (i % 5000 == 4999) {
            EXPECT_TRUE(ask(probe, R"({"find":"boards","limit":1})"));
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

TEST(Registry, History_TellsWhatHappenedAlsoAfterARestart) {
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

TEST(Registry, BadOptions_EndWithStatus2AndSayWhatToDo) {
    for (const std::vector<std::string>& more : {std::vector<std::string>{"--forget-after", "soon"},
                                                 {"--id", "a/b"},
                                                 {"--max-boards", "0"},
                                                 {"--nonsense"},
                                                 {"--history-size", "1"}}) {
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
