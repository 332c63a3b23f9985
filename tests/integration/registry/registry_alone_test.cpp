// SPDX-License-Identifier: Apache-2.0
// What a registry may expect of others and does not get: an id of its own, permission to clear, a clean
// start.
#include <gmock/gmock.h>

#include "asip/text/wall_time.hpp"
#include "running_registry.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::test {
namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size()))
        ++count;
    return count;
}

TEST(RegistryIdentity, SecondOfOneId_EndsWithStatus6AndTheFirstIsUnharmed) {
    MosquittoBroker broker;
    RunningRegistry first(broker.address(), "hall");
    ASSERT_TRUE(first.complete());
    RunningRegistry second(broker.address(), "hall");
    EXPECT_EQ(second.process().wait_exit(), 6);
    EXPECT_THAT(second.process().errors(), testing::HasSubstr("another registry uses this id"));
    BusProbe probe(broker.port());
    EXPECT_TRUE(probe.wait_for("asip/registry/hall/$state", "online"));
    EXPECT_TRUE(ask(probe, R"({"find":"boards"})", "hall")) << "the first one answers on";
    EXPECT_EQ(probe.last("asip/registry/hall/$state"), "online") << "no goodbye of the other";
}

TEST(RegistryIdentity, KilledAndStartedAgain_ItsIdIsItsOwn) {
    MosquittoBroker broker;
    {
        RunningRegistry first(broker.address(), "hall");
        ASSERT_TRUE(first.complete());
        first.process().signal(9);
        first.process().wait_exit();
    }
    RunningRegistry again(broker.address(), "hall");
    ASSERT_TRUE(again.complete());
    BusProbe probe(broker.port());
    EXPECT_TRUE(ask(probe, R"({"find":"boards"})", "hall"));
    EXPECT_TRUE(again.process().running());
}

TEST(RegistryHistory, StartedThreeTimes_TimesGoOnAndNoRowIsWritten) {
    MosquittoBroker broker;
    TempDir folder;
    const std::vector<std::string> history{"--history", folder.file("history.db")};
    BusProbe probe(broker.port());
    probe.publish(announcement("uno1", description_text("uno1", "a", 1), 60));
    probe.publish("asip/servicebus/uno1/$state", "online", true, 1);
    std::optional<text::WallTime> first_seen, since;
    for (int start = 0; start < 3; ++start) {
        RunningRegistry registry(broker.address(), "r1", history);
        ASSERT_TRUE(registry.complete());
        ASSERT_TRUE(becomes(probe, "uno1", "online"));
        const auto board = ask(probe, R"({"find":"boards"})")->boards.at(0);
        const auto rows = ask(probe, R"({"find":"history"})")->history;
        ASSERT_EQ(rows.size(), 1u) << "start " << start;
        EXPECT_EQ(rows[0].what, "added");
        if (start > 0) {
            const auto difference = [](auto a, auto b) { return std::chrono::abs(a - b); };
            EXPECT_LT(difference(board.first_seen, *first_seen), std::chrono::milliseconds(20));
            EXPECT_LT(difference(board.since, *since), std::chrono::milliseconds(20));
        } else {
            first_seen = board.first_seen;
            since = board.since;
        }
        registry.process().signal(15);
        ASSERT_EQ(registry.process().wait_exit(), 0);
    }
}

TEST(RegistryAccess, MayNotClearWhatABoardLeft_ReportsItOnceAndForgettingContinues) {
    const TempDir folder;
    const std::string rules = folder.write("acl",
                                           "user registry\ntopic read asip/#\ntopic write asip/servicebus/#\n"
                                           "topic write asip/registry/#\ntopic write asip/reply/#\n"
                                           "user admin\ntopic readwrite #\n");
    MosquittoBroker::Options options;
    options.users = {{"registry", "r"}, {"admin", "a"}};
    options.extra_lines = {"acl_file " + rules};
    MosquittoBroker broker(options);
    BusProbe::Options admin;
    admin.user = "admin";
    admin.password = "a";
    BusProbe probe(broker.port(), {"asip/#"}, admin);
    RunningRegistry registry(broker.address(), "r1",
                             {"--user", "registry", "--password-file", folder.write("password", "r\n")});
    ASSERT_TRUE(registry.complete());
    const auto denials = [&] { return count_of(registry.process().errors(), "access rules do not let"); };
    const auto losses = [&] { return count_of(registry.process().errors(), "connection lost"); };
    for (const std::string board : {"uno1", "uno2", "uno3"}) {
        probe.publish(announcement(board, description_text(board, "a", 1), 60));
        probe.publish("asip/servicebus/" + board + "/$state", "offline", true, 1);
        probe.publish("asip/" + board + "/in", "I,d,13,1", true, 1);
        probe.publish("asip/" + board + "/io/out", "{}", true, 1);
        ASSERT_TRUE(becomes(probe, board, "offline"));
        const auto answer = ask_to_forget(probe, board, "r1");
        ASSERT_TRUE(answer);
        EXPECT_THAT(answer->forgotten, testing::ElementsAre(board));
        EXPECT_TRUE(probe.wait_for("asip/servicebus/" + board + "/$state", ""));
        if (board == "uno1") {
            EXPECT_TRUE(wait_until([&] { return denials() == 1; })) << registry.process().errors();
        }
    }
    EXPECT_EQ(denials(), 1u) << registry.process().errors();
    EXPECT_LE(losses(), 1u) << "the MQTT library may lose the connection over a denial, once";
    EXPECT_TRUE(ask(probe, R"({"find":"boards"})", "r1"));
}

TEST(RegistryService, BrokerThatRefusesIt_IsAskedAgainByAServiceAlone) {
    MosquittoBroker::Options options;
    options.users = {{"registry", "r"}};
    MosquittoBroker broker(options);
    RunningRegistry by_hand(broker.address());
    EXPECT_EQ(by_hand.process().wait_exit(), 3);
    ChildProcess service({ASIP_REGISTRY_PROGRAM, "--broker", broker.address(), "--id", "r1"},
                         {{"NOTIFY_SOCKET", "/nonexistent/socket"}});
    EXPECT_TRUE(service.wait_for_errors("asking again")) << service.errors();
    EXPECT_TRUE(service.running());
    service.signal(15);
    EXPECT_EQ(service.wait_exit(), 0);
}

TEST(RegistryService, IdThatAnotherOneHas_IsAskedForAgainByAService) {
    MosquittoBroker broker;
    RunningRegistry first(broker.address(), "hall");
    ASSERT_TRUE(first.complete());
    ChildProcess second({ASIP_REGISTRY_PROGRAM, "--broker", broker.address(), "--id", "hall"},
                        {{"NOTIFY_SOCKET", "/nonexistent/socket"}});
    EXPECT_TRUE(second.wait_for_errors("beginning again")) << second.errors();
    second.signal(15);
    EXPECT_EQ(second.wait_exit(), 0);
}

}  // namespace
}  // namespace asip::test
