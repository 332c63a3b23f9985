// SPDX-License-Identifier: Apache-2.0
// Links at their agent: requests, the disk, and how commands end. Their rules: tests/unit/links.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "agent/links/link_files.hpp"
#include "asip/property/documents.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/unit/agent/online_bridge.hpp"
#include "tests/unit/links/contact.hpp"

namespace asip::agent {
namespace {

using links::contact;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kLinks = "asip/uno1/$links";

/// A servo, and the button of another board.
struct LinkedBridge : OnlineBridge {
    json ask(json request, const std::string& user = "ann", const std::string& id = "1") {
        return bench.ask("asip/uno1/$link/" + user + "/c", std::move(request), id);
    }
    static json link(const std::string& name, json more = json::object()) {
        json made{{"name", name}, {"from", "desk/io/2"}, {"to", "servo/0/angle"}, {"value", 90}, {"else", 0}};
        made.update(more);
        return {{"set", made}};
    }
    void kept(std::uint64_t ticket, const Expected<void>& result = {}) {
        bench.run([&](Effects& out) { bench.bridge.link_kept(ticket, result, bench.now, out); });
    }
    void kept_all() {
        for (const auto& each : std::exchange(bench.links_to_keep, {}))
            kept(each.ticket);
    }
    void set(const std::string& name, json more = json::object()) {
        ask(link(name, std::move(more)));
        kept_all();
    }
    /// Over the connection for sources.
    void source(const std::string& topic, const std::string& payload) {
        mqtt::Message message;
        message.topic = topic;
        message.payload = payload;
        bench.run([&](Effects& out) { bench.bridge.source_message(message, bench.now, out); });
    }
    void desk_is_there() {
        source("asip/servicebus/desk/$state", "online");
        source("asip/servicebus/desk/$properties",
               property::to_text(property::PropertyList{{"desk", "a", 1}, {contact()}}));
        desk(false);
    }
    void desk(bool on, std::vector<property::ButtonEvent> events = {}) {
        property::ValueDocument document;
        document.head = {"desk", "a", ++seq};
        document.clock = "x-1";
        property::ShownValue shown;
        shown.value = on;
        shown.how = property::How::kReported;
        shown.events = std::move(events);
        document.values["io/2"] = shown;
        source("asip/desk/$values", property::to_text(document));
    }
    void person(int angle) {
        bench.ask("asip/uno1/in", {{"raw", "S,W,0," + std::to_string(angle)}}, "p" + std::to_string(++seq));
    }
    json shown() const { return json::parse(bench.on(kLinks).back()); }
    std::uint64_t seq = 0;
};

TEST_F(LinkedBridge, TwoPressesAtOnce_ThenAPersonThenAnotherPress) {
    set("l", {{"when", "toggles"}});
    desk_is_there();
    desk(false, {{1, property::ButtonAct::kPress}, {2, property::ButtonAct::kPress}});
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,90", "S,W,0,0"));
    person(90);
    desk(false, {{3, property::ButtonAct::kPress}});
    EXPECT_EQ(bench.board.executed.back(), "S,W,0,0");
}

TEST_F(LinkedBridge, PressesThatWaitedWhileTheAgentWasFrozen_DoNothing_AndTheNextOneDoes) {
    set("l", {{"when", "toggles"}});
    desk_is_there();
    const auto frozen = bench.now;
    bench.now += 10s;
    bench.bridge.not_watched(frozen, bench.now);
    desk(false, {{1, property::ButtonAct::kPress}});
    desk(false, {{2, property::ButtonAct::kPress}});
    EXPECT_THAT(bench.board.executed, IsEmpty());
    bench.pass(2s);
    desk(false, {{3, property::ButtonAct::kPress}});
    ASSERT_THAT(bench.board.executed, ElementsAre("S,W,0,90"));
    bench.bridge.not_watched(bench.now - 600ms, bench.now);
    desk(false, {{4, property::ButtonAct::kPress}});
    EXPECT_EQ(bench.board.executed.back(), "S,W,0,0") << "a machine that is busy";
}

TEST_F(LinkedBridge, LastLinkRemoved_NothingIsDueOfTheBoardThatWasItsSource) {
    set("l");
    desk_is_there();
    ask({{"remove", "l"}});
    kept_all();
    for (int i = 0; i < 200; ++i) {
        bench.now += 1s;
        bench.run([&](Effects& out) { bench.bridge.tick(bench.now, out); });
        EXPECT_GT(bench.bridge.next_deadline().value_or(Time::max()), bench.now) << "after " << i << " s";
    }
}

TEST_F(LinkedBridge, SameLinkAgain_APersonStillWins) {
    set("l");
    desk_is_there();
    desk(true);
    person(45);
    set("l");
    bench.pass(10s);
    EXPECT_THAT(bench.board.executed, ElementsAre("S,W,0,0", "S,W,0,90", "S,W,0,45"));
    EXPECT_EQ(json::parse(bench.on("answers").back())["status"], "ok");
}

TEST_F(LinkedBridge, StoredStop_StopsNoLink) {
    set("l");
    desk_is_there();
    bench.hear("asip/uno1/$stop", "{}", true);
    bench.pass(1s);
    EXPECT_FALSE(shown()["links"][0].contains("suspended"));
    bench.hear("asip/uno1/$stop", "{}");
    bench.pass(1s);
    EXPECT_TRUE(shown()["links"][0].contains("suspended"));
}

TEST_F(LinkedBridge, FloodOfRequests_IsRefusedWhileTheDiskIsBusy) {
    for (int i = 0; i < 1000; ++i)
        ask(link("l" + std::to_string(i % 50)), "ann", std::to_string(i));
    EXPECT_EQ(bench.links_to_keep.size(), LinkBook::kMaxUnwritten);
    EXPECT_EQ(json::parse(bench.on("answers").back())["reason"], "queue-full");
    EXPECT_LE(bench.on(kLinks).size(), 2U) << "each is shown";
    kept_all();
    ask(link("l1"), "ann", "x");
    kept_all();
    EXPECT_EQ(json::parse(bench.on("answers").back())["status"], "ok");
}

TEST_F(LinkedBridge, FloodOfBadRequests_ShowsNothingAndIsLoggedAFewTimes) {
    set("l");
    bench.pass(1s);
    bench.published.clear();
    const auto before = bench.logged;
    for (int i = 0; i < 1000; ++i)
        bench.hear("asip/uno1/$link/ann/c", "{\"remove\":\"x\"}");
    bench.pass(100ms);
    EXPECT_THAT(bench.on(kLinks), IsEmpty());
    EXPECT_LE(bench.logged - before, 25U);
}

TEST_F(LinkedBridge, FlickeringSource_IsWrittenOnceASecond) {
    set("l");
    desk_is_there();
    bench.links_to_keep.clear();
    for (int i = 0; i < 1000; ++i) {
        desk(i % 2 == 0);
        bench.pass(10ms);
        kept_all();
    }
    bench.links_to_keep.clear();
    int writes = 0;
    for (int i = 0; i < 1000; ++i) {
        desk(i % 2 == 0);
        bench.pass(10ms);
        writes += static_cast<int>(bench.links_to_keep.size());
        kept_all();
    }
    EXPECT_GE(writes, 9);
    EXPECT_LE(writes, 11);
    person(45);
    bench.release_holds();
    ASSERT_FALSE(bench.links_to_keep.empty());
    EXPECT_THAT(bench.links_to_keep.back().text, HasSubstr("suspended")) << "what the next agent needs";
}

TEST_F(LinkedBridge, DiskThatFailsTwice_LeavesWhatIsOnIt) {
    ask(link("l"));
    ask(link("l", {{"value", 45}}), "ann", "2");
    ASSERT_EQ(bench.links_to_keep.size(), 2U);
    kept(bench.links_to_keep[0].ticket, fail("full"));
    kept(bench.links_to_keep[1].ticket, fail("full"));
    bench.pass(1s);
    EXPECT_THAT(bench.on(kLinks).back(), IsEmpty());
}

TEST_F(LinkedBridge, UserThatCouldNotBeRead_IsRefused) {
    EXPECT_EQ(ask(link("l"), std::string(65, 'u'))["status"], "refused");
    EXPECT_THAT(bench.links_to_keep, IsEmpty());
}

TEST_F(LinkedBridge, LinkOfAnother_IsLeftAlone) {
    set("l");
    for (const auto& request : {link("l"), json{{"remove", "l"}}, json{{"disable", "l"}}})
        EXPECT_THAT(ask(request, "bob")["error"].get<std::string>(), HasSubstr("is one of ann"));
    EXPECT_THAT(bench.links_to_keep, IsEmpty());
}

TEST_F(LinkedBridge, UserWithManyLinks_LeavesRoomForOthers) {
    for (std::size_t i = 0; i < links::kMaxOfAUser; ++i)
        set("l" + std::to_string(i));
    EXPECT_EQ(ask(link("more"), "ann", "x")["error"],
              "the board has 50 links of ann already: remove one first");
    EXPECT_THAT(bench.links_to_keep, IsEmpty());
    set("l1", {{"value", 80}});
    EXPECT_EQ(json::parse(bench.on("answers").back())["status"], "ok") << "one of these";
    ask(link("of-bob"), "bob", "y");
    kept_all();
    EXPECT_EQ(json::parse(bench.on("answers").back())["status"], "ok");
}

TEST_F(LinkedBridge, CommandOfALink_DoesNotWaitBehindClientsWithoutAReply) {
    set("l");
    desk_is_there();
    bench.board.mute = true;
    for (int i = 0; i < 200; ++i)
        bench.hear("asip/uno1/servo/in", "W,0," + std::to_string(i % 90));
    desk(true);
    bench.pass(500ms);
    EXPECT_THAT(shown()["links"][0].value("last", ""), HasSubstr("set to 90"));
}

TEST(LinkFilesTest, LongCommand_IsReadAgain) {
    test::TempDir folder;
    LinkFiles files{folder.path()};
    json notes = json::array();
    for (int i = 0; i < 300; ++i)
        notes.push_back(440);
    auto link = links::read_link({{"name", "l"},
                                  {"from", "desk/io/2"},
                                  {"to", "tone"},
                                  {"when", "press"},
                                  {"command", {{"play", notes}}}});
    ASSERT_TRUE(link) << link.error();
    ASSERT_TRUE(files.save("lamp", "l", to_text({*link, {}})));
    const auto loaded = files.load("lamp");
    ASSERT_THAT(loaded.faults, IsEmpty());
    EXPECT_EQ(loaded.links.at(0).link, *link);
    ASSERT_TRUE(files.save("lamp", "l", {}));
    EXPECT_THAT(files.load("lamp").links, IsEmpty());
}

TEST(LinkFilesTest, ManyDamaged_AFewAreNamed) {
    test::TempDir folder;
    const auto path = folder.path() / "links" / "lamp";
    std::filesystem::create_directories(path);
    for (int i = 0; i < 200; ++i)
        std::ofstream(path / (std::to_string(i) + ".json")) << std::string(1000, '{');
    EXPECT_EQ(LinkFiles(folder.path()).load("lamp").faults.size(), 20U);
}

}  // namespace
}  // namespace asip::agent
