// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <csignal>

#include "running_registry.hpp"
#include "tests/support/catalogue_view.hpp"

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
    ASSERT_TRUE(probe.wait_for("asip/registry/r1/$state", "online"));
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
        if (const auto answer = ask(probe, R"({"find":"boards"})", registry))
            for (const auto& item : answer->boards)
                text += item.board + " " + item.state + " " + item.session + "\n";
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
        for (; fed < messages.size(); ++fed)
            if (auto event = bus::parse_change_event(messages[fed].payload)) view.event(*event);
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
