// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "catalogue_bench.hpp"
#include "tests/support/catalogue_check.hpp"

namespace asip::catalogue {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Kind = Event::Kind;

TEST_F(CatalogueTest, FirstDescription_AddsBoardOnline) {
    EXPECT_THAT(give(description("uno1")), ElementsAre(Kind::kAdded));
    const auto item = board("uno1", 5s);
    EXPECT_EQ(item.state, "online");
    EXPECT_EQ(item.chip, "ATmega328P");
    EXPECT_EQ(item.sketch, "AsipHello");
    EXPECT_EQ(item.agent, "pi asip-agent-1");
    EXPECT_EQ(item.link, "serial /dev/ttyACM0");
    EXPECT_EQ(item.age, 5);
    ASSERT_EQ(item.services.size(), 2u);
    EXPECT_EQ(item.services[0].name, "distance");
    EXPECT_EQ(item.services[0].kind, "distance");
    EXPECT_EQ(item.services[0].count, 2);
    EXPECT_EQ(item.services[0].period, 100);
    EXPECT_EQ(item.services[1].title, "Servos");
}

TEST_F(CatalogueTest, LeaseRunsOut_BoardIsLostAtThatVeryMoment) {
    give(description("uno1"));
    EXPECT_THAT(expire(60s - 1ns), IsEmpty());
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_THAT(expire(60s), ElementsAre(Kind::kState, Kind::kGhost));
    EXPECT_EQ(state_of("uno1"), "lost");
}

TEST_F(CatalogueTest, LeasesOfManyRunOut_SomeAreJudgedAtATime_AndOneThatIsHeardMeanwhileStays) {
    for (int i = 0; i < 5; ++i)
        give(description("uno" + std::to_string(i)));
    EXPECT_EQ(catalogue.expire(at(60s), 2).size(), 4u) << "of each a state and what to clear";
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_EQ(state_of("uno2"), "online");
    EXPECT_LE(*catalogue.next_expiry(), at(60s));
    give(description("uno4", {.seq = 2}), 60s);
    EXPECT_EQ(catalogue.expire(at(60s), 100).size(), 4u);
    EXPECT_EQ(state_of("uno3"), "lost");
    EXPECT_EQ(state_of("uno4"), "online");
}

TEST_F(CatalogueTest, LeaseRunsOutWhereBrokerForgetsByItself_LeavesRetainedTopicAlone) {
    auto message = description("uno1");
    message.expiry_seconds = 60;
    give(message);
    EXPECT_THAT(expire(60s), ElementsAre(Kind::kState));
}

TEST_F(CatalogueTest, NewerNumberWithSameContent_RenewsWithoutEvent) {
    give(description("uno1"));
    EXPECT_THAT(give(description("uno1", {.seq = 2}), 50s), IsEmpty());
    EXPECT_THAT(expire(109s), IsEmpty());
    EXPECT_THAT(expire(110s), ElementsAre(Kind::kState, Kind::kGhost));
    EXPECT_EQ(catalogue.stats().renewals, 1u);
}

TEST_F(CatalogueTest, NewerNumberWithOtherServices_ReportsDescription) {
    give(description("uno1"));
    EXPECT_THAT(
        give(description("uno1", {.seq = 2, .services = R"([{"name":"io","id":"I","model":"io@1"}])"})),
        ElementsAre(Kind::kDescription));
    EXPECT_THAT(catalogue.services_by_kind(), ElementsAre(std::pair<std::string, std::size_t>("io", 1)));
}

TEST_F(CatalogueTest, OlderNumber_ChangesNothing) {
    give(description("uno1", {.seq = 7}));
    EXPECT_THAT(give(description("uno1", {.seq = 6, .services = "[]"}), 50s), IsEmpty());
    EXPECT_EQ(refused, Refusal::kOldSequence);
    EXPECT_EQ(board("uno1").services.size(), 2u);
    EXPECT_THAT(expire(60s), ElementsAre(Kind::kState, Kind::kGhost)) << "the lease was not renewed";
}

TEST_F(CatalogueTest, RepeatedNumber_RenewsTheLeaseOfALivingBoardOnly) {
    give(description("uno1"));
    give(description("uno1"), 30s);
    EXPECT_THAT(expire(60s), IsEmpty());
    give(state("uno1", "offline"), 61s);
    give(description("uno1"), 62s);
    EXPECT_EQ(state_of("uno1"), "offline");
}

TEST_F(CatalogueTest, GoodbyeThenNewSession_IsOnlineAgain) {
    give(description("uno1", {.session = "a", .seq = 9}));
    EXPECT_THAT(give(state("uno1", "offline")), ElementsAre(Kind::kState));
    EXPECT_EQ(state_of("uno1"), "offline");
    EXPECT_THAT(give(description("uno1", {.session = "b", .seq = 1})),
                ElementsAre(Kind::kState, Kind::kDescription));
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_EQ(board("uno1").session, "b");
}

TEST_F(CatalogueTest, LateWillOfTheSessionBefore_IsPutRightByTheAgent) {
    give(description("uno1"));
    give(state("uno1", "lost"));
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_THAT(give(state("uno1", "online")), ElementsAre(Kind::kState));
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_F(CatalogueTest, SleepingAndUpdatingAreBelievedWhileTheLeaseRuns) {
    give(description("uno1"));
    give(state("uno1", "sleeping"), 1s);
    EXPECT_EQ(state_of("uno1"), "sleeping");
    give(description("uno1", {.seq = 2}), 2s);
    EXPECT_EQ(state_of("uno1"), "sleeping") << "a renewal says nothing of sleep";
    expire(62s);
    EXPECT_EQ(state_of("uno1"), "lost");
}

TEST_F(CatalogueTest, NamesAlone_MakeAFullMember) {
    EXPECT_THAT(give(board_name("esp1")), ElementsAre(Kind::kListen, Kind::kAdded));
    EXPECT_THAT(give(service_name("esp1", "Distance")), ElementsAre(Kind::kDescription));
    EXPECT_THAT(give(service_name("esp1", "Servos\n")), ElementsAre(Kind::kDescription));
    EXPECT_THAT(give(service_name("esp1", "Servos")), IsEmpty());
    const auto item = board("esp1");
    EXPECT_TRUE(item.names_only);
    EXPECT_EQ(item.state, "online");
    ASSERT_EQ(item.services.size(), 2u);
    EXPECT_EQ(item.services[0].name, "Distance");
    EXPECT_EQ(item.services[1].kind, "Servos");
}

TEST_F(CatalogueTest, Traffic_RenewsABoardOfNamesOnly) {
    give(board_name("esp1"), 0s);
    give(traffic("esp1"), 50s);
    EXPECT_THAT(expire(109s), IsEmpty());
    EXPECT_THAT(expire(110s), ElementsAre(Kind::kState));
    EXPECT_THAT(give(traffic("esp1"), 120s), ElementsAre(Kind::kState));
    EXPECT_EQ(state_of("esp1"), "online");
}

TEST_F(CatalogueTest, TrafficOfUnknownOrDescribedBoards_ChangesNothing) {
    give(traffic("nobody"));
    EXPECT_EQ(catalogue.size(), 0u);
    give(description("uno1"));
    give(traffic("uno1"), 50s);
    EXPECT_THAT(expire(60s), ElementsAre(Kind::kState, Kind::kGhost));
}

TEST_F(CatalogueTest, DescriptionAfterNames_Replaces) {
    give(service_name("uno1", "Distance"));
    EXPECT_THAT(give(description("uno1")), ElementsAre(Kind::kUnlisten, Kind::kDescription));
    EXPECT_FALSE(board("uno1").names_only);
    EXPECT_EQ(board("uno1").services.size(), 2u);
    EXPECT_THAT(give(service_name("uno1", "Other")), IsEmpty());
    EXPECT_EQ(board("uno1").services.size(), 2u);
}

TEST_F(CatalogueTest, LostForLongerThanForgetAfter_IsForgotten) {
    give(description("uno1"));
    expire(60s);
    EXPECT_THAT(expire(60s + 7 * 24h - 1ns), IsEmpty());
    EXPECT_THAT(expire(60s + 7 * 24h), ElementsAre(Kind::kForgotten));
    EXPECT_EQ(catalogue.size(), 0u);
    EXPECT_THAT(catalogue.services_by_kind(), IsEmpty());
}

TEST_F(CatalogueTest, Forget_OnlyWhatIsNotAlive) {
    give(description("uno1"));
    EXPECT_EQ(catalogue.forget("uno1", at(1s)).error(), Catalogue::NotForgotten::kAlive);
    EXPECT_EQ(catalogue.forget("uno2", at(1s)).error(), Catalogue::NotForgotten::kUnknown);
    give(state("uno1", "offline"));
    EXPECT_THAT(catalogue.forgettable("*"), ElementsAre("uno1"));
    EXPECT_THAT(kinds(*catalogue.forget("uno1", at(2s))), ElementsAre(Kind::kForgotten));
    EXPECT_EQ(catalogue.size(), 0u);
    EXPECT_EQ(CatalogueCheck::check(catalogue), "");
}

TEST_F(CatalogueTest, EmptiedStateTopic_ForgetsADeadBoardButNotALivingOne) {
    give(description("uno1"));
    EXPECT_THAT(give(state("uno1", "")), IsEmpty());
    EXPECT_EQ(state_of("uno1"), "online");
    give(state("uno1", "lost"));
    EXPECT_THAT(give(state("uno1", "")), ElementsAre(Kind::kForgotten));
}

TEST_F(CatalogueTest, Suspended_JudgesNoLeaseAndGivesGraceAfterwards) {
    give(description("uno1"));
    give(description("uno2"));
    catalogue.suspend();
    EXPECT_THAT(expire(1000s), IsEmpty());
    EXPECT_EQ(catalogue.next_expiry(), std::nullopt);
    catalogue.resume(at(1000s));
    EXPECT_THAT(expire(1009s), IsEmpty());
    give(description("uno2", {.seq = 2}), 1009s);
    EXPECT_THAT(expire(1010s), ElementsAre(Kind::kState, Kind::kGhost));
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_EQ(state_of("uno2"), "online");
}

TEST_F(CatalogueTest, NamesWereHeardLast_GraceBehindAnInterruptionIsNoTimeInWhichTheBoardWasThere) {
    give(description("uno1"));
    expire(60s);
    give(board_name("uno1"), 70s);  // the description that came with it was never heard
    give(board_name("esp1"), 70s);
    catalogue.suspend();
    catalogue.resume(at(200s));
    give(retained(description("uno1", {.seq = 9}), 3), 201s);
    expire(210s);
    EXPECT_EQ(board("uno1", 210s).state_age, 6) << "since what was stored ended";
    EXPECT_EQ(board("esp1", 210s).state_age, 80) << "since a minute behind its name";
}

TEST_F(CatalogueTest, NamesWithAStoredWordButNoDescription_HaveToBeHeardAgainBehindAnInterruption) {
    give(board_name("uno1"));
    give(board_name("esp1"));  // takes part by names alone: its lease is the usual one
    catalogue.suspend();
    catalogue.resume(at(20s));
    give(retained(state("uno1", "online")), 20s);
    expire(31s);
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_EQ(state_of("esp1"), "online");
}

TEST_F(CatalogueTest, ChangesAreNumberedWithoutGap) {
    std::vector<std::uint64_t> numbers;
    const auto collect = [&](std::vector<Event> events) {
        for (const Event& event : events)
            if (event.is_change()) numbers.push_back(event.seq);
    };
    collect(catalogue.apply(description("uno1").view(), at(0s)).events);
    collect(catalogue.apply(board_name("esp1").view(), at(0s)).events);
    collect(catalogue.apply(state("uno1", "sleeping").view(), at(0s)).events);
    collect(catalogue.expire(at(60s)));
    EXPECT_THAT(numbers, ElementsAre(1, 2, 3, 4, 5));
    EXPECT_EQ(catalogue.seq(), 5u);
}

TEST_F(CatalogueTest, Full_RefusesNewBoardsAndKeepsTheOld) {
    Catalogue small({.max_boards = 1});
    small.apply(description("uno1").view(), at(0s));
    EXPECT_EQ(small.apply(description("uno2").view(), at(0s)).refused, Refusal::kTooMany);
    EXPECT_EQ(small.apply(state("uno3", "online").view(), at(0s)).refused, Refusal::kTooMany);
    EXPECT_EQ(small.apply(board_name("uno4").view(), at(0s)).refused, Refusal::kTooMany);
    EXPECT_EQ(small.size(), 1u);
    EXPECT_EQ(CatalogueCheck::check(small), "");
}

}  // namespace
}  // namespace asip::catalogue
