#include "registry/catalogue/catalogue.hpp"

#include <gmock/gmock.h>

#include "bus_messages.hpp"

namespace asip::registry {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Kind = Event::Kind;

class CatalogueTest : public testing::Test {
  protected:
    std::vector<Kind> give(const OwnedMessage& message, Duration when = 0s) {
        auto applied = catalogue.apply(message.view(), at(when));
        refused = applied.refused;
        EXPECT_EQ(catalogue.check(), "");
        return kinds(applied.events);
    }
    std::vector<Kind> expire(Duration when) {
        auto events = catalogue.expire(at(when));
        EXPECT_EQ(catalogue.check(), "");
        return kinds(events);
    }
    static std::vector<Kind> kinds(const std::vector<Event>& events) {
        std::vector<Kind> result;
        for (const Event& event : events)
            result.push_back(event.kind);
        return result;
    }
    bus::BoardItem board(const std::string& name, Duration when = 0s) {
        return catalogue.board(name, instant(at(when))).value_or(bus::BoardItem{});
    }
    std::string state_of(const std::string& name) { return board(name).state; }

    Catalogue catalogue;
    std::optional<Refusal> refused;
};

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

TEST_F(CatalogueTest, RestartedAgent_TakesOverAtOnceAndReplaysOfTheOldSessionChangeNothing) {
    give(description("uno1", {.session = "a", .seq = 40}));
    EXPECT_THAT(give(description("uno1", {.session = "b", .seq = 1})), ElementsAre(Kind::kDescription));
    for (std::uint64_t seq = 1; seq <= 40; ++seq) {
        EXPECT_THAT(give(description("uno1", {.session = "a", .seq = seq, .services = "[]"})), IsEmpty());
        EXPECT_EQ(refused, Refusal::kOldSession);
    }
    EXPECT_EQ(board("uno1").session, "b");
    EXPECT_EQ(board("uno1").services.size(), 2u);
}

TEST_F(CatalogueTest, TwoLivingSessions_OneConflictReportedAndNoAlternation) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    std::vector<Kind> all;
    std::vector<std::string> holders;
    for (std::uint64_t round = 2; round < 12; ++round) {
        for (const char* session : {"a", "b"}) {
            const auto events = give(description("uno1", {.session = session, .seq = round}), round * 1s);
            all.insert(all.end(), events.begin(), events.end());
            holders.push_back(board("uno1").session);
        }
    }
    EXPECT_THAT(all, ElementsAre(Kind::kConflict));
    EXPECT_THAT(holders, testing::Each("b"));
    const auto item = board("uno1");
    ASSERT_TRUE(item.conflict);
    EXPECT_EQ(item.conflict->holder, "b");
    EXPECT_EQ(item.conflict->other, "a");
    EXPECT_EQ(item.conflict->other_agent, "pi asip-agent-1");
    EXPECT_EQ(catalogue.stats().conflicts, 1u);
}

TEST_F(CatalogueTest, TwoLivingSessionsWithTheSmallerLast_TheLargerStillEndsAsHolder) {
    give(description("uno1", {.session = "b", .seq = 1}), 0s);
    give(description("uno1", {.session = "a", .seq = 1}), 1s);
    int changes_of_hand = 0;
    std::string holder = "a";
    for (std::uint64_t round = 2; round < 12; ++round) {
        for (const char* session : {"b", "a"}) {
            give(description("uno1", {.session = session, .seq = round}), round * 1s);
            if (board("uno1").session != holder) ++changes_of_hand;
            holder = board("uno1").session;
        }
    }
    EXPECT_EQ(holder, "b");
    EXPECT_EQ(changes_of_hand, 1);
    EXPECT_EQ(catalogue.stats().conflicts, 1u);
}

TEST_F(CatalogueTest, OneMessageOfTheReplacedSessionUnderWay_IsNoConflict) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    give(description("uno1", {.session = "a", .seq = 2}), 1s);
    for (std::uint64_t seq = 2; seq < 9; ++seq) {
        EXPECT_THAT(give(description("uno1", {.session = "b", .seq = seq}), seq * 20s), IsEmpty());
    }
    EXPECT_EQ(board("uno1").session, "b");
    EXPECT_FALSE(board("uno1").conflict);
}

TEST_F(CatalogueTest, OtherSessionFallsSilent_ConflictIsResolved) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    give(description("uno1", {.session = "a", .seq = 2}), 2s);
    give(description("uno1", {.session = "b", .seq = 2}), 3s);
    EXPECT_THAT(give(description("uno1", {.session = "a", .seq = 3}), 4s), ElementsAre(Kind::kConflict));
    EXPECT_THAT(give(description("uno1", {.session = "b", .seq = 3}), 40s), IsEmpty());
    EXPECT_THAT(give(description("uno1", {.session = "b", .seq = 4}), 64s), ElementsAre(Kind::kResolved));
    EXPECT_EQ(catalogue.stats().conflicts, 0u);
}

TEST_F(CatalogueTest, HolderFallsSilent_OtherSessionHoldsTheBoard) {
    give(description("uno1", {.session = "a", .seq = 1}), 0s);
    give(description("uno1", {.session = "b", .seq = 1}), 1s);
    give(description("uno1", {.session = "a", .seq = 2}), 2s);
    give(description("uno1", {.session = "b", .seq = 2}), 3s);
    give(description("uno1", {.session = "a", .seq = 3}), 50s);
    EXPECT_THAT(expire(63s), ElementsAre(Kind::kState, Kind::kResolved, Kind::kGhost));
    give(description("uno1", {.session = "a", .seq = 4}), 64s);
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_EQ(board("uno1").session, "a");
}

TEST_F(CatalogueTest, RetainedDescriptionWithExpiry_LivesForWhatIsLeft) {
    give(retained(description("uno1"), 17));
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_THAT(expire(17s), ElementsAre(Kind::kState));
}

TEST_F(CatalogueTest, RetainedDescriptionWithoutExpiry_LivesForTheTimeToAnswerAProbe) {
    give(retained(description("uno1")));
    EXPECT_EQ(state_of("uno1"), "online");
    EXPECT_THAT(expire(10s), ElementsAre(Kind::kState, Kind::kGhost));
    give(retained(description("uno1")), 11s);
    EXPECT_EQ(state_of("uno1"), "lost") << "the same replay again proves nothing";
}

TEST_F(CatalogueTest, RetainedStateAloneMakesNobodyAlive) {
    EXPECT_THAT(give(retained(state("uno1", "online"))), ElementsAre(Kind::kAdded));
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_THAT(give(description("uno1")), ElementsAre(Kind::kState, Kind::kDescription));
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_F(CatalogueTest, RetainedLostAndDescriptionInEitherOrder_IsLost) {
    give(retained(description("uno1"), 40));
    give(retained(state("uno1", "lost")));
    give(retained(state("uno2", "lost")));
    give(retained(description("uno2"), 40));
    EXPECT_EQ(state_of("uno1"), "lost");
    EXPECT_EQ(state_of("uno2"), "lost");
    EXPECT_EQ(board("uno2").services.size(), 2u);
}

TEST_F(CatalogueTest, ReplayedStateAgainstALivingBoard_IsOnlyAHint) {
    give(description("uno1"));
    give(retained(state("uno1", "lost")));
    EXPECT_EQ(refused, Refusal::kOldHint);
    EXPECT_EQ(state_of("uno1"), "online");
    catalogue.suspend();
    catalogue.resume(at(5s));
    give(retained(state("uno1", "offline")), 5s);
    EXPECT_EQ(state_of("uno1"), "offline") << "it may have said so while we were away";
}

TEST_F(CatalogueTest, RetainedDescriptionOfAnUnknownSessionAgainstALivingBoard_IsRefused) {
    give(description("uno1", {.session = "b"}));
    give(retained(description("uno1", {.session = "old", .seq = 99, .services = "[]"})));
    EXPECT_EQ(refused, Refusal::kUnproven);
    EXPECT_EQ(board("uno1").session, "b");
}

TEST_F(CatalogueTest, LiveSessionAfterAnUnprovenRetainedOne_TakesOverWithoutConflict) {
    give(retained(description("uno1", {.session = "old", .seq = 99}), 50));
    give(description("uno1", {.session = "b"}), 1s);
    EXPECT_EQ(board("uno1").session, "b");
    give(retained(description("uno1", {.session = "old", .seq = 99}), 50), 2s);
    EXPECT_EQ(refused, Refusal::kOldSession);
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

TEST_F(CatalogueTest, TrafficRenewsABoardThatLivesByNames) {
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
    EXPECT_EQ(catalogue.check(), "");
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

TEST_F(CatalogueTest, ChangesAreNumberedWithoutGap) {
    std::vector<std::uint64_t> numbers;
    const auto collect = [&](std::vector<Event> events) {
        for (const Event& event : events) {
            if (event.is_change()) numbers.push_back(event.seq);
        }
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
    EXPECT_EQ(small.check(), "");
}

struct Bad {
    const char* name;
    OwnedMessage message;
    Refusal refusal;
};

class BadMessageTest : public testing::TestWithParam<Bad> {};

TEST_P(BadMessageTest, IsRefusedWithItsReason_ChangesNothing_AndTheNextGoodOneWorks) {
    Catalogue catalogue;
    catalogue.apply(description("uno1").view(), at(0s));
    const std::string before = catalogue.fingerprint();
    const auto applied = catalogue.apply(GetParam().message.view(), at(1s));
    EXPECT_EQ(applied.refused, GetParam().refusal);
    EXPECT_THAT(applied.events, IsEmpty());
    EXPECT_EQ(catalogue.fingerprint(), before);
    EXPECT_EQ(catalogue.check(), "");
    EXPECT_EQ(catalogue.stats().refused[static_cast<std::size_t>(GetParam().refusal)], 1u);
    EXPECT_FALSE(catalogue.apply(description("uno1", {.seq = 2}).view(), at(2s)).refused);
    EXPECT_FALSE(catalogue.apply(description("uno2").view(), at(2s)).refused);
}

OwnedMessage raw_description(const std::string& payload, const std::string& board = "uno1") {
    return {bus::TopicKind::kDescription, board, payload};
}
OwnedMessage with_services(const std::string& services) {
    return description("uno1", {.seq = 2, .services = services});
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadMessageTest,
    testing::Values(
        Bad{"NoJson", raw_description("hello"), Refusal::kMalformed},
        Bad{"CutOff", raw_description(R"({"board":"uno1","session":"a","seq":2,"services":[)"),
            Refusal::kMalformed},
        Bad{"TrailingBytes", raw_description(R"({"board":"uno1","session":"a","seq":2,"services":[]} x)"),
            Refusal::kMalformed},
        Bad{"NoServices", raw_description(R"({"board":"uno1","session":"a","seq":2})"), Refusal::kMalformed},
        Bad{"NegativeSeq", raw_description(R"({"board":"uno1","session":"a","seq":-2,"services":[]})"),
            Refusal::kMalformed},
        Bad{"FractionalSeq", raw_description(R"({"board":"uno1","session":"a","seq":2.5,"services":[]})"),
            Refusal::kMalformed},
        Bad{"HugeSeq",
            raw_description(R"({"board":"uno1","session":"a","seq":99999999999999999999,"services":[]})"),
            Refusal::kMalformed},
        Bad{"EmptySession", raw_description(R"({"board":"uno1","session":"","seq":2,"services":[]})"),
            Refusal::kMalformed},
        Bad{"BoardTwice",
            raw_description(R"({"board":"uno1","board":"uno1","session":"a","seq":2,"services":[]})"),
            Refusal::kMalformed},
        Bad{"NoUtf8",
            raw_description(
                "{\"board\":\"uno1\",\"session\":\"a\",\"seq\":2,\"services\":[],\"x\":\"\xff\"}"),
            Refusal::kMalformed},
        Bad{"TooDeep",
            raw_description(R"({"board":"uno1","session":"a","seq":2,"services":[],"x":)" +
                            std::string(5000, '[') + std::string(5000, ']') + "}"),
            Refusal::kMalformed},
        Bad{"TooLong", raw_description(std::string(65 * 1024, ' ')), Refusal::kTooLong},
        Bad{"OtherBoard", raw_description(R"({"board":"uno2","session":"a","seq":2,"services":[]})"),
            Refusal::kWrongBoard},
        Bad{"ReservedName",
            raw_description(R"({"board":"registry","session":"a","seq":2,"services":[]})", "registry"),
            Refusal::kBadName},
        Bad{"ServicesNoList", with_services("{}"), Refusal::kMalformed},
        Bad{"ServiceNoObject", with_services("[1]"), Refusal::kMalformed},
        Bad{"ServiceWithoutName", with_services(R"([{"id":"D"}])"), Refusal::kMalformed},
        Bad{"ServiceWithInvalidName", with_services(R"([{"name":"a/b"}])"), Refusal::kMalformed},
        Bad{"ServiceTwice", with_services(R"([{"name":"a"},{"name":"a"}])"), Refusal::kMalformed},
        Bad{"ServiceWithLongId", with_services(R"([{"name":"a","id":"DD"}])"), Refusal::kMalformed},
        Bad{"ServiceWithInvalidModel", with_services(R"([{"name":"a","model":"a b@1"}])"),
            Refusal::kMalformed},
        Bad{"ServiceWithNegativeCount", with_services(R"([{"name":"a","count":-1}])"), Refusal::kMalformed},
        Bad{"UnknownState", state("uno1", "dead"), Refusal::kBadState},
        Bad{"StateOfInvalidName", state("a b", "online"), Refusal::kBadName},
        Bad{"EmptyBoardName", board_name(""), Refusal::kBadName},
        Bad{"BoardNameWithSlash", board_name("a/b"), Refusal::kBadName},
        Bad{"BoardNameReserved", board_name("servicebus"), Refusal::kBadName},
        Bad{"LongBoardName", board_name(std::string(65, 'a')), Refusal::kBadName},
        Bad{"ServiceNameInvalid", service_name("uno1", "a+b"), Refusal::kBadName}),
    [](const auto& param) { return param.param.name; });

TEST_F(CatalogueTest, TooManyServices_AreRefused) {
    std::string services = "[";
    for (int i = 0; i < 65; ++i)
        services += (i > 0 ? "," : "") + (R"({"name":"s)" + std::to_string(i) + "\"}");
    give(description("uno1", {.services = services + "]"}));
    EXPECT_EQ(refused, Refusal::kMalformed);
    for (int i = 0; i < 64; ++i)
        give(service_name("esp1", "s" + std::to_string(i)));
    EXPECT_EQ(refused, std::nullopt);
    give(service_name("esp1", "s64"));
    EXPECT_EQ(refused, Refusal::kTooMany);
}

TEST_F(CatalogueTest, UnknownMembersAndOwnModels_AreKeptInTheFullDescription) {
    const std::string payload =
        R"({"x-note":"hi \"there\"","board":"uno1","session":"a","seq":1,"services":[{"name":"foo","id":"F",)"
        R"("model":{"name":"foo","events":{"e":{"fields":[{"name":"v","unit":"lux"}]}}}}]})";
    give(raw_description(payload));
    bus::Query query;
    query.full = true;
    const auto answer = catalogue.find(query, instant(at(0s)));
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->boards.size(), 1u);
    EXPECT_THAT(answer->boards[0].description, testing::HasSubstr(R"("x-note":"hi \"there\"")"));
    EXPECT_THAT(answer->boards[0].description, testing::HasSubstr(R"("unit":"lux")"));
    EXPECT_EQ(answer->boards[0].services[0].kind, "foo");
}

}  // namespace
}  // namespace asip::registry
