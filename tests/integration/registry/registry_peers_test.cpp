// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <csignal>

#include "asip/bus/registry/catalogue_view.hpp"
#include "running_registry.hpp"

namespace asip::test {
namespace {

using Kind = bus::ChangeEvent::Kind;

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

/// Boards of all states, as a registry lists them, but for when it heard of them.
std::string listed(BusProbe& probe, const std::string& registry) {
    std::string text;
    const auto answer = ask(probe, R"({"find":"boards","limit":1000})", registry);
    if (!answer) return "no answer";
    for (const auto& item : answer->boards)
        text += item.board + " " + item.state + " " + item.session + " " + std::to_string(item.seq) + " " +
                std::to_string(item.services.size()) + "\n";
    return text;
}

/// A registry that knows 161 boards, and has told so.
struct LargeSite {
    LargeSite() {
        EXPECT_TRUE(first.complete());
        probe.publish(announcement("gone", description_text("gone", "a", 1, 60), 60));
        probe.publish("asip/servicebus/gone/$state", "offline", true, 1);
        for (int i = 100; i < 260; ++i) {
            const std::string board = "board" + std::to_string(i);
            probe.publish(announcement(board, description_text(board, "a", 1, 60), 60));
        }
        EXPECT_TRUE(becomes(probe, "board259", "online", "first"));
        EXPECT_TRUE(wait_until([this] {
            const auto text = probe.last("asip/registry/first/$stats");
            return text && text->find("\"online\":160") != std::string::npos;
        }));
    }

    MosquittoBroker broker;
    RunningRegistry first{broker.address(), "first", {"--stats-interval", "1s"}};
    BusProbe probe{broker.port(), {"asip/registry/+/$stats", "asip/servicebus/$probe"}};
};

TEST(RegistryBesideALargeOne, ReadsItsPagesAndIsHeardByAll) {
    LargeSite site;
    const auto probes = site.probe.messages("asip/servicebus/$probe").size();
    RunningRegistry second(site.broker.address(), "second", {"--copy-boards", "100"});
    ASSERT_TRUE(second.process().wait_for_errors("catalogue is complete  boards=161"));
    EXPECT_THAT(second.process().errors(), testing::HasSubstr("read from registry=first"));
    EXPECT_EQ(listed(site.probe, "second"), listed(site.probe, "first"));
    EXPECT_EQ(site.probe.messages("asip/servicebus/$probe").size(), probes) << "no board was asked";
    site.probe.publish(announcement("board100", description_text("board100", "a", 2, 1), 1));
    EXPECT_TRUE(becomes(site.probe, "board100", "lost", "second")) << "leases are judged";
}

TEST(RegistryBesideALargeOne, ThatDoesNotAnswer_ReadsWhatTheBrokerRetains) {
    LargeSite site;
    site.first.process().signal(SIGSTOP);
    RunningRegistry second(site.broker.address(), "second", {"--copy-boards", "100"});
    ASSERT_TRUE(second.process().wait_for_errors("catalogue is complete  boards=161"))
        << second.process().errors();
    EXPECT_THAT(second.process().errors(), testing::Not(testing::HasSubstr("read from")));
    EXPECT_EQ(state_of(site.probe, "board200", "second"), "online");
    site.first.process().signal(SIGCONT);
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
    std::size_t reported = 0;
    bus::CatalogueView view([&](const bus::CatalogueView::Change&) { ++reported; });
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
    EXPECT_GT(reported, 150u);
}

}  // namespace
}  // namespace asip::test
