// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/demander.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/model/description.hpp"

namespace asip::bus {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using Services = std::map<std::string, double>;

struct DemanderBench : testing::Test {
    Demander demander{Topics(), "ann", "c1", [] { return std::uint64_t{0}; }};
    Time now{1000s};

    DemanderBench() { demander.connected(now); }

    /// What is said within `time`: topic's board and the services.
    std::vector<std::pair<std::string, Services>> pass(Duration time = 0s) {
        std::vector<std::pair<std::string, Services>> said;
        const Time end = now + time;
        while (true) {
            for (const auto& message : demander.due(now)) {
                const auto topic = Topics().parse(message.topic);
                EXPECT_TRUE(topic && topic->kind == TopicKind::kDemand && topic->demander == "ann/c1")
                    << message.topic;
                EXPECT_FALSE(message.retain);
                said.emplace_back(topic->board, parse_demand(message.payload).value().services);
            }
            const auto next = demander.next_deadline();
            if (!next || *next > end) break;
            now = std::max(*next, now);
        }
        now = end;
        return said;
    }
};

TEST_F(DemanderBench, Want_IsToldToBoardsOnDemandOnly_AndRenewedAtAThirdOfTheLease) {
    const auto want = demander.want("uno1", "distance", 5);
    demander.description("uno2", true, now);
    EXPECT_THAT(pass(), IsEmpty());
    demander.description("uno1", false, now);
    EXPECT_THAT(pass(1min), IsEmpty());
    demander.description("uno1", true, now);
    EXPECT_THAT(pass(), ElementsAre(std::pair("uno1", Services{{"distance", 5}})));
    EXPECT_THAT(pass(16s), SizeIs(3));
}

TEST_F(DemanderBench, SeveralWants_AreOneMessageWithTheFastestOfEach) {
    const auto slow = demander.want("uno1", "distance", 1);
    auto fast = demander.want("uno1", "distance", 20);
    const auto io = demander.want("uno1", "io");
    const auto all = demander.want("uno*", "*", 2);
    demander.description("uno1", true, now);
    EXPECT_THAT(pass(),
                ElementsAre(std::pair("uno1", Services{{"distance", 20}, {"io", kUsualHz}, {"*", 2}})));
    fast.reset();
    EXPECT_THAT(pass(1s),
                ElementsAre(std::pair("uno1", Services{{"distance", 1}, {"io", kUsualHz}, {"*", 2}})));
}

TEST_F(DemanderBench, LastWantThatEnds_IsToldOnce) {
    demander.description("uno1", true, now);
    auto want = demander.want("*", "*");
    pass();
    want.reset();
    EXPECT_THAT(pass(1min), ElementsAre(std::pair("uno1", Services{})));
}

TEST_F(DemanderBench, BoardThatAnnouncesItself_IsToldAgain_AtMostOnceASecond) {
    const auto want = demander.want("uno1", "io", 3);
    demander.description("uno1", true, now);
    pass();
    for (int i = 0; i < 100; ++i)
        demander.description("uno1", true, now);
    EXPECT_THAT(pass(900ms), IsEmpty());
    EXPECT_THAT(pass(200ms), SizeIs(1));
}

TEST_F(DemanderBench, WantsThatComeAndGo_AreToldFourTimesASecond) {
    demander.description("uno1", true, now);
    std::size_t said = 0;
    for (int i = 0; i < 1000; ++i) {
        auto want = demander.want("uno1", "io", i + 1);
        said += pass(1ms).size();
    }
    EXPECT_LE(said, 5u);
}

TEST_F(DemanderBench, LostConnection_NothingIsSaid_AndAllOfItAfterTheNext) {
    const auto want = demander.want("uno1", "io", 3);
    demander.description("uno1", true, now);
    pass();
    demander.disconnected();
    EXPECT_THAT(pass(1min), IsEmpty());
    demander.connected(now);
    EXPECT_THAT(pass(), SizeIs(1));
}

TEST_F(DemanderBench, End_LeavesWhereItWasCountedOn) {
    demander.description("uno1", true, now);
    demander.description("uno2", true, now);
    const auto want = demander.want("uno1", "io");
    pass();
    const auto last = demander.leave();
    ASSERT_THAT(last, SizeIs(1));
    EXPECT_EQ(last[0].topic, "asip/servicebus/uno1/$demand/ann/c1");
    EXPECT_THAT(parse_demand(last[0].payload).value().services, IsEmpty());
    EXPECT_THAT(demander.leave(), IsEmpty());
}

TEST_F(DemanderBench, MoreServicesThanADemandHolds_AreAllOfThem) {
    demander.description("uno1", true, now);
    std::vector<Demander::Want> wants;
    for (std::size_t i = 0; i <= kMaxDemandedServices; ++i)
        wants.push_back(demander.want("uno1", "s" + std::to_string(i), 1 + static_cast<double>(i)));
    EXPECT_THAT(pass(), ElementsAre(std::pair("uno1", Services{{"*", 33}})));
}

TEST_F(DemanderBench, WhatNoServiceCanBeCalled_SpoilsNothing) {
    demander.description("uno1", true, now);
    const auto good = demander.want("uno1", "io", 1e308);
    const auto slow = demander.want("uno1", "servo", std::nan(""));
    for (const char* service : {"", "a b", "!!", "a/b"})
        EXPECT_EQ(demander.want("*", service, 5), nullptr);
    EXPECT_THAT(pass(), ElementsAre(std::pair("uno1", Services{{"io", 1000}, {"servo", .001}})));
}

TEST_F(DemanderBench, Message_IsReadOnlyWhereItDescribesItsBoard) {
    const auto want = demander.want("*", "*");
    model::Description description;
    description.board = "uno1";
    description.session = "s";
    description.on_demand = model::OnDemandInfo{20, 0};
    mqtt::Message message;
    message.payload = model::to_text(description);
    for (const char* topic : {"asip/servicebus/uno2/$description", "asip/servicebus/uno1/$stats", "x"}) {
        message.topic = topic;
        demander.take(message, now);
    }
    EXPECT_THAT(pass(1s), IsEmpty());
    message.topic = "asip/servicebus/uno1/$description";
    demander.take(message, now);
    EXPECT_THAT(pass(), SizeIs(1));
    message.payload.clear();
    demander.take(message, now);
    EXPECT_THAT(pass(1min), IsEmpty()) << "its agent is gone";
}

TEST(Demander, WantThatOutlivesIt_IsHarmless) {
    Demander::Want want;
    {
        Demander demander(Topics(), "", "c1", system_random());
        want = demander.want("uno1", "io");
    }
    want.reset();
}

}  // namespace
}  // namespace asip::bus
