// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/program/exit_status.hpp"
#include "tests/unit/agent/bridge_bench.hpp"

namespace asip::agent {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const std::string kState = "asip/servicebus/uno1/$state";
const std::string kDescription = "asip/servicebus/uno1/$description";
const std::string kProbe = "asip/servicebus/$probe";

std::string foreign_description(const std::string& session, std::uint64_t seq = 1,
                                model::BoardState state = model::BoardState::kOnline) {
    model::Description other;
    other.state = model::SaidState{state};
    other.board = "uno1";
    other.session = session;
    other.seq = seq;
    other.agent = {"0.1.0", "pi", "asip-agent-pi-1"};
    return model::to_text(other);
}

model::Description last_description(const BridgeBench& bench) {
    return *model::parse_description(bench.on(kDescription).back());
}

TEST(Announcer, BoardAndBusThere_NameIsProbedThenAnnouncedInBothLayers) {
    BridgeBench bench;
    bench.plug();
    bench.connect();
    EXPECT_THAT(bench.on(kProbe), ElementsAre("uno1"));
    EXPECT_THAT(bench.on(kState), IsEmpty());
    bench.pass(1500ms);
    EXPECT_THAT(bench.on(kState), ElementsAre("online"));
    EXPECT_THAT(bench.on("asip/servicebus"), ElementsAre("uno1"));
    EXPECT_THAT(bench.on("asip/servicebus/uno1"), ElementsAre("io", "servo", "distance"));
    ASSERT_EQ(bench.on(kDescription).size(), 1u);
    const auto description = model::parse_description(bench.on(kDescription)[0]);
    ASSERT_TRUE(description) << description.error();
    EXPECT_EQ(description->pins.owners, "@@IISD");
    EXPECT_EQ(description->services.size(), 3u);
    EXPECT_EQ(description->agent.client, "client");
}

TEST(Announcer, BusThatKnowsItsUsers_NothingGoesOutWhereNoRuleTiesItToTheSender) {
    auto options = BridgeBench::defaults();
    options.on_shared_topic = false;
    OnlineBench bench(options);
    EXPECT_THAT(bench.on("asip/servicebus"), IsEmpty());
    EXPECT_THAT(bench.on("asip/servicebus/uno1"), ElementsAre("io", "servo", "distance"));
}

TEST(Announcer, ItsRenewalsAndProbes_DoNotComeBackToIt) {
    BridgeBench bench;
    bench.plug();
    for (const auto& [filter, options] : bench.bridge.subscriptions()) {
        EXPECT_EQ(options.no_local, filter != kState) << filter;
        EXPECT_EQ(options.qos, filter == "asip/servicebus/$probe" ? 0 : 1)
            << filter << ": whoever sees may probe";
    }
}

TEST(Announcer, StateAndDescription_AreRetainedAndTheDescriptionExpiresWithTheLease) {
    OnlineBench bench;
    for (const auto& publication : bench.published) {
        if (publication.message.topic == kState) {
            EXPECT_TRUE(publication.message.retain);
        }
        if (publication.message.topic != kDescription) continue;
        EXPECT_TRUE(publication.message.retain);
        EXPECT_EQ(publication.message.expiry_seconds, 60u);
    }
    EXPECT_EQ(bench.bridge.will().payload, "lost");
    EXPECT_TRUE(bench.bridge.will().retain);
}

TEST(Announcer, Lease_IsRenewedAtAThirdWithARisingSeq) {
    OnlineBench bench;
    bench.published.clear();
    bench.pass(60s);
    const auto descriptions = bench.on(kDescription);
    ASSERT_GE(descriptions.size(), 2u);
    ASSERT_LE(descriptions.size(), 5u);
    EXPECT_EQ(model::parse_description(descriptions[0])->seq + 1,
              model::parse_description(descriptions[1])->seq);
    EXPECT_THAT(bench.on(kState), IsEmpty()) << "a renewal is the description alone";
    EXPECT_THAT(bench.on("asip/servicebus"), IsEmpty());
    EXPECT_THAT(bench.on("asip/servicebus/uno1"), IsEmpty());
}

TEST(Announcer, Renewal_IsNotAcknowledgedAndTheAnnouncementIs) {
    OnlineBench bench;
    const auto all_of = [](int qos) {
        return testing::Each(testing::Truly([qos](const auto& publication) {
            return publication.message.topic != kDescription || publication.message.qos == qos;
        }));
    };
    EXPECT_THAT(bench.published, all_of(1));
    bench.published.clear();
    bench.pass(60s);
    EXPECT_THAT(bench.published, all_of(0));
    bench.published.clear();
    bench.hear(kProbe, "");
    bench.pass(1s);
    EXPECT_THAT(bench.published, all_of(1));
}

TEST(Announcer, ProbeAndRenewalTogether_NamesAreAnnouncedToo) {
    OnlineBench bench;
    bench.published.clear();
    bench.hear(kProbe, "");
    bench.pass(1s);
    EXPECT_THAT(bench.on(kState), ElementsAre("online"));
    EXPECT_THAT(bench.on("asip/servicebus"), ElementsAre("uno1"));
    EXPECT_THAT(bench.on("asip/servicebus/uno1"), ElementsAre("io", "servo", "distance"));
}

TEST(Announcer, Probe_IsAnsweredWithinASecond) {
    OnlineBench bench;
    for (const char* payload : {"", "uno1"}) {
        bench.published.clear();
        bench.hear(kProbe, payload);
        bench.pass(1s);
        EXPECT_EQ(bench.on(kDescription).size(), 1u);
    }
    bench.published.clear();
    bench.hear(kProbe, "other");
    bench.pass(1s);
    EXPECT_THAT(bench.on(kDescription), IsEmpty());
}

TEST(Announcer, OwnStateWrittenBySomebody_IsPutRight) {
    OnlineBench bench;
    const auto before = last_description(bench).seq;
    bench.published.clear();
    bench.hear(kState, "online");
    EXPECT_THAT(bench.on(kState), IsEmpty());
    bench.hear(kState, "lost");
    EXPECT_THAT(bench.on(kState), ElementsAre("online"));
    EXPECT_EQ(last_description(bench).seq, before + 1) << "which a view believes";
    bench.hear(kState, "");
    EXPECT_THAT(bench.on(kState), ElementsAre("online", "online"));
}

TEST(Announcer, OwnDescriptionEmptiedOrSpoilt_IsThereAgainAtOnce) {
    OnlineBench bench;
    for (const auto* text : {"", "{", R"({"services":7})"}) {
        bench.pass(1s);
        bench.published.clear();
        bench.hear(kDescription, text);
        bench.pass(1s);
        ASSERT_EQ(bench.on(kDescription).size(), 1u) << text;
        for (const auto& each : bench.published)
            EXPECT_TRUE(each.message.topic != kDescription || each.message.retain);
    }
}

// As by a program that empties all below a topic, which takes its time.
TEST(Announcer, AllThatIsRetainedEmptied_IsThereAgainASecondLater) {
    OnlineBench bench;
    for (const auto& emptied : {kState, kDescription}) {
        bench.pass(5s);
        bench.published.clear();
        for (int i = 0; i < 20; ++i) {
            bench.hear(emptied, "");
            bench.pass(10ms);
        }
        EXPECT_THAT(bench.on("asip/servicebus/uno1/$properties"), IsEmpty()) << "it would be emptied, too";
        bench.pass(1s);
        EXPECT_THAT(bench.on("asip/servicebus/uno1/$properties"), SizeIs(1));
        EXPECT_THAT(bench.on("asip/uno1/$values"), SizeIs(1));
    }
    bench.published.clear();
    bench.hear("asip/servicebus/$probe", "");
    bench.pass(2s);
    EXPECT_THAT(bench.on("asip/servicebus/uno1/$properties"), IsEmpty()) << "a question who is there";
}

TEST(Announcer, StateThatIsRetainedBehindOurs_IsPutRight) {
    OnlineBench bench;
    bench.bridge.bus_disconnected();
    bench.connect();
    bench.published.clear();
    bench.hear(kState, "online", true);
    EXPECT_THAT(bench.on(kState), IsEmpty());
    bench.hear(kState, "lost", true);
    EXPECT_THAT(bench.on(kState), ElementsAre("online"));
}

TEST(Announcer, LivingHolderAnswersTheClaim_EndsAndNamesIt) {
    BridgeBench bench;
    bench.plug();
    bench.connect();
    bench.hear(kDescription, foreign_description("0"));
    ASSERT_TRUE(bench.fatal);
    EXPECT_EQ(bench.fatal->status, program::kExitNameConflict);
    EXPECT_THAT(bench.fatal->text, HasSubstr("asip-agent-pi-1 on pi"));
    EXPECT_THAT(bench.on(kState), IsEmpty());
}

TEST(Announcer, Takeover_AnnouncesALaterSessionThanTheHolders) {
    auto options = BridgeBench::defaults();
    options.takeover = true;
    BridgeBench bench(options);
    bench.plug();
    bench.connect();
    bench.hear(kDescription, foreign_description("ffff"));
    bench.pass(1500ms);
    EXPECT_FALSE(bench.fatal);
    ASSERT_EQ(bench.on(kDescription).size(), 1u);
    EXPECT_GT(model::parse_description(bench.on(kDescription)[0])->session, "ffff");
}

TEST(Announcer, LaterSessionAnnouncesOurNameAndAnswersTheProbe_WeEnd) {
    OnlineBench bench;
    bench.published.clear();
    bench.hear(kDescription, foreign_description("ffffffffffffffff"));
    EXPECT_FALSE(bench.fatal);
    EXPECT_THAT(bench.on(kProbe), ElementsAre("uno1"));
    bench.pass(500ms);
    bench.hear(kDescription, foreign_description("ffffffffffffffff", 2));
    ASSERT_TRUE(bench.fatal);
    EXPECT_EQ(bench.fatal->status, program::kExitNameConflict);
}

TEST(Announcer, LaterSessionAnnouncesOurNameAndSaysGoodbye_WeStayAsTheLaterOne) {
    for (const std::uint64_t goodbye : {1, 2}) {
        OnlineBench bench;
        if (goodbye == 2) bench.hear(kDescription, foreign_description("ffffffffffffffff"));
        bench.hear(kDescription,
                   foreign_description("ffffffffffffffff", goodbye, model::BoardState::kOffline));
        bench.hear(kState, "offline");
        bench.pass(2s);
        EXPECT_FALSE(bench.fatal);
        EXPECT_GT(model::parse_description(bench.on(kDescription).back())->session, "ffffffffffffffff");
        EXPECT_EQ(bench.on(kState).back(), "online");
    }
}

TEST(Announcer, WhileALaterSessionIsAsked_WhatTheBrokerHasOfItStays) {
    OnlineBench bench;
    bench.published.clear();
    bench.hear(kDescription, foreign_description("ffffffffffffffff", 7, model::BoardState::kOffline), true);
    bench.hear(kState, "offline");
    bench.pass(500ms);
    ASSERT_FALSE(bench.on(kDescription).empty());
    for (const auto& [message, priority] : bench.published)
        EXPECT_FALSE(message.retain) << message.topic << " " << message.payload;
    bench.published.clear();
    bench.pass(1500ms);
    EXPECT_GT(last_description(bench).session, "ffffffffffffffff");
    EXPECT_TRUE(std::any_of(bench.published.begin(), bench.published.end(), [](const auto& one) {
        return one.message.topic == kDescription && one.message.retain;
    }));
}

TEST(Announcer, GoneWhileALaterSessionIsAsked_TheWordIsStoredAlone) {
    OnlineBench bench;
    bench.hear(kDescription, foreign_description("ffffffffffffffff"), true);
    bench.published.clear();
    bench.unplug();
    ASSERT_THAT(bench.on(kState), ElementsAre("lost"));
    for (const auto& [message, priority] : bench.published)
        EXPECT_EQ(message.retain, message.topic == kState) << message.topic;
}

TEST(Announcer, BrokerLostWhileALaterSessionIsAsked_ItIsAskedAgainAndOursBecomesTheLaterOne) {
    OnlineBench bench;
    bench.hear(kDescription, foreign_description("ffffffffffffffff"));
    bench.bridge.bus_disconnected();
    bench.pass(5s);
    bench.published.clear();
    bench.connect();
    EXPECT_THAT(bench.on(kProbe), ElementsAre("uno1"));
    bench.pass(2s);
    EXPECT_FALSE(bench.fatal);
    EXPECT_GT(model::parse_description(bench.on(kDescription).back())->session, "ffffffffffffffff");
}

TEST(Announcer, HolderSaysGoodbyeDuringOurClaim_TheNameIsOursAsTheLaterOne) {
    BridgeBench bench;
    bench.plug();
    bench.connect();
    bench.hear(kDescription, foreign_description("ffffffffffffff00", 9, model::BoardState::kOffline));
    bench.pass(1500ms);
    EXPECT_FALSE(bench.fatal);
    ASSERT_EQ(bench.on(kDescription).size(), 1u);
    EXPECT_GT(model::parse_description(bench.on(kDescription)[0])->session, "ffffffffffffff00");
}

TEST(Announcer, OneForgedDescription_IsPutRightAndWeStay) {
    OnlineBench bench;
    bench.published.clear();
    bench.hear(kDescription, foreign_description("ffffffffffffffff"));
    bench.hear(kDescription, foreign_description("ffffffffffffffff"));
    bench.pass(2s);
    EXPECT_FALSE(bench.fatal);
    ASSERT_FALSE(bench.on(kDescription).empty());
    EXPECT_GT(model::parse_description(bench.on(kDescription).back())->session, "ffffffffffffffff")
        << "the later one is believed";
    EXPECT_EQ(bench.ask("asip/uno1/servo/in", {{"write", {0, 90}}})["status"], "ok");
}

TEST(Announcer, FloodOfProbes_IsAnsweredTwiceASecondAtMost) {
    OnlineBench bench;
    bench.published.clear();
    for (int i = 0; i < 1000; ++i) {
        bench.hear(kProbe, "");
        bench.pass(10ms);
    }
    EXPECT_LE(bench.on(kDescription).size(), 21u);
    EXPECT_GE(bench.on(kDescription).size(), 8u);
}

TEST(Announcer, ControlSubscriptionNotGranted_IsNotOnline) {
    BridgeBench bench;
    bench.grants_subscriptions = false;
    bench.go_online();
    bench.pass(60s);
    EXPECT_THAT(bench.on(kState), IsEmpty());
    EXPECT_THAT(bench.on(kDescription), IsEmpty());
    Effects effects;
    bench.bridge.bus_subscribed(bench.now, effects);
    EXPECT_FALSE(effects.publish.empty());
    EXPECT_EQ(effects.publish.at(0).message.topic, kDescription);
    EXPECT_EQ(effects.publish.at(1).message.payload, "online");
}

TEST(Announcer, OlderSessionIsReplayed_WeAnnounceAgainAndStay) {
    OnlineBench bench;
    bench.published.clear();
    bench.hear(kDescription, foreign_description("0000000001"));
    bench.pass(1s);
    EXPECT_FALSE(bench.fatal);
    EXPECT_EQ(bench.on(kDescription).size(), 1u);
}

TEST(Announcer, BoardUnplugged_EachDescriptionSaysForHowLongAndWhyUntilItIsBack) {
    OnlineBench bench;
    bench.pass(100s);
    bench.published.clear();
    bench.unplug();
    ASSERT_EQ(bench.on(kDescription).size(), 1u);
    EXPECT_EQ(last_description(bench).state,
              (model::SaidState{model::BoardState::kLost, model::StateReason::kUnplugged}));
    EXPECT_EQ(bench.published.front().message.topic, kDescription) << "the reason comes first";
    bench.pass(200s);
    bench.hear(kProbe, "");
    bench.pass(1s);
    EXPECT_GT(bench.on(kDescription).size(), 10u) << "its agent lives";
    EXPECT_EQ(bench.on(kState), (std::vector<std::string>{"lost", "lost"}));
    for (const auto& each : bench.on(kDescription)) {
        const auto said = model::parse_description(each)->state;
        ASSERT_TRUE(said);
        EXPECT_EQ(said->state, model::BoardState::kLost);
        EXPECT_EQ(said->reason, model::StateReason::kUnplugged);
    }
    EXPECT_NEAR(last_description(bench).state->age, 200.5, 0.6);
    bench.plug();
    EXPECT_EQ(last_description(bench).state, model::SaidState{});
}

TEST(Announcer, BoardFallsSilent_TheDescriptionSaysSo) {
    OnlineBench bench;
    bench.board.mute = true;
    bench.pass(20s);
    EXPECT_EQ(last_description(bench).state->reason, model::StateReason::kSilent);
    bench.unplug();
    EXPECT_EQ(last_description(bench).state->reason, model::StateReason::kUnplugged);
}

TEST(Announcer, StoredDescriptionOfALaterSession_OursIsMadeTheLaterOne) {
    BridgeBench bench;
    bench.plug();
    bench.connect();
    bench.hear(kDescription, foreign_description("00ffffffff123456"), true);
    bench.hear(kDescription, "no json");
    bench.pass(1500ms);
    EXPECT_FALSE(bench.fatal);
    EXPECT_THAT(bench.on(kState), ElementsAre("online"));
    EXPECT_GT(last_description(bench).session, "00ffffffff123456");
    EXPECT_EQ(last_description(bench).session.size(), 16u);
}

TEST(Announcer, BrokerBack_AnnouncesAtOnceWithoutAnotherClaim) {
    OnlineBench bench;
    bench.bridge.bus_disconnected();
    bench.unplug();
    bench.published.clear();
    bench.connect();
    EXPECT_THAT(bench.on(kState), ElementsAre("lost"));
    EXPECT_EQ(bench.on(kDescription).size(), 1u);
    EXPECT_THAT(bench.on(kProbe), IsEmpty());
    EXPECT_THAT(bench.on("asip/servicebus"), IsEmpty());
    bench.pass(1s);
    EXPECT_THAT(bench.on("asip/servicebus"), ElementsAre("uno1")) << "commands come first";
    EXPECT_THAT(bench.on("asip/servicebus/uno1"), testing::Not(IsEmpty()));
    EXPECT_EQ(bench.on(kDescription).size(), 1u);
}

TEST(Announcer, Goodbye_PublishesOffline) {
    OnlineBench bench;
    Effects effects;
    bench.bridge.goodbye(bench.now, effects);
    ASSERT_FALSE(effects.publish.empty());
    EXPECT_EQ(effects.publish.back().message.topic, kState);
    EXPECT_EQ(effects.publish.back().message.payload, "offline");
    ASSERT_EQ(effects.publish.size(), 2u);
    const auto said = model::parse_description(effects.publish.front().message.payload)->state;
    EXPECT_EQ(said->state, model::BoardState::kOffline);
    EXPECT_EQ(said->reason, model::StateReason::kStopped);
}

TEST(Announcer, NameNotGiven_IsTheStoredOneElseFromThePort) {
    auto options = BridgeBench::defaults();
    options.name.clear();
    BridgeBench stored(options);
    stored.board.stored_name = "greenhouse";
    stored.plug();
    EXPECT_EQ(stored.bridge.name(), "greenhouse");
    BridgeBench old(options);
    old.board.extensions = false;
    old.plug();
    EXPECT_EQ(old.bridge.name(), "ttyACM0");
}

}  // namespace
}  // namespace asip::agent
