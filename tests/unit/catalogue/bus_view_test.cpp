// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/bus_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cli/boards.hpp"

namespace asip::catalogue {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Time kNow{4000s};

class BusViewTest : public ::testing::Test {
  protected:
    std::string retained(const std::string& topic, const std::string& payload) {
        return view_.apply({.topic = topic, .payload = payload, .retain = true}, kNow);
    }
    std::string live(const std::string& topic, const std::string& payload, Time now = kNow) {
        return view_.apply({.topic = topic, .payload = payload}, now);
    }
    std::optional<bus::BoardItem> look(const std::string& name, Time now = kNow) {
        return view_.board(name, {now, {}});
    }
    std::string state_of(const std::string& name) {
        const auto item = look(name);
        return item ? item->state : "unknown";
    }

    BusView view_{bus::Topics("asip")};
};

TEST_F(BusViewTest, DescriptionAndState_MakeABoard) {
    retained("asip/servicebus/uno1/$state", "online");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    const auto board = look("uno1");
    ASSERT_TRUE(board);
    EXPECT_EQ(board->state, "online");
    EXPECT_EQ(board->chip, "ATmega328P");
    EXPECT_EQ(board->agent, "pi asip-agent-1");
    ASSERT_EQ(board->services.size(), 4U);
    EXPECT_EQ(board->services[1].kind, "distance");
    EXPECT_EQ(board->services[1].count, 2);
    EXPECT_EQ(board->services[3].kind, "X");
    EXPECT_LT(board->age, 0) << "what is retained says nothing of when it was heard";
}

TEST_F(BusViewTest, OnlineWithoutDescription_IsLost) {
    retained("asip/servicebus/uno1/$state", "online");
    EXPECT_EQ(state_of("uno1"), "lost");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    EXPECT_EQ(state_of("uno1"), "online");
    retained("asip/servicebus/uno1/$description", "");
    EXPECT_EQ(state_of("uno1"), "online") << "who tidies up says nothing of the board";
}

TEST_F(BusViewTest, WillAndGoodbye_AreReported) {
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    retained("asip/servicebus/uno1/$state", "lost");
    EXPECT_EQ(state_of("uno1"), "lost");
    retained("asip/servicebus/uno1/$state", "offline");
    EXPECT_EQ(state_of("uno1"), "offline");
}

TEST_F(BusViewTest, EverythingEmptied_IsForgotten) {
    retained("asip/servicebus/uno1/$state", "lost");
    EXPECT_EQ(live("asip/servicebus/uno1/$state", ""), "uno1");
    EXPECT_FALSE(view_.knows("uno1"));
}

TEST_F(BusViewTest, NamesAlone_MakeABoardThatIsThere) {
    live("asip/servicebus", "esp", kNow);
    live("asip/servicebus/esp", "distance", kNow);
    live("asip/servicebus/esp", "distance", kNow + 2s);
    const auto board = look("esp", kNow + 5s);
    ASSERT_TRUE(board);
    EXPECT_TRUE(board->names_only);
    EXPECT_EQ(board->state, "online");
    ASSERT_EQ(board->services.size(), 1U);
    EXPECT_EQ(board->services[0].name, "distance");
    EXPECT_DOUBLE_EQ(board->age, 3.0);
}

TEST_F(BusViewTest, LeaseRunOut_IsLostUntilTheNextDescription) {
    retained("asip/servicebus/uno1/$state", "online");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    const auto lease = std::chrono::seconds(view_.description("uno1")->lease);
    EXPECT_EQ(look("uno1", kNow + lease - 1s)->state, "online");
    EXPECT_EQ(look("uno1", kNow + lease)->state, "lost");
    live("asip/servicebus/uno1/$description", cli::kUno1, kNow + lease);
    EXPECT_EQ(look("uno1", kNow + lease)->state, "online");
}

TEST_F(BusViewTest, NamesNotHeardForAMinute_AreLost) {
    live("asip/servicebus", "esp", kNow);
    EXPECT_EQ(look("esp", kNow + 59s)->state, "online");
    EXPECT_EQ(look("esp", kNow + 60s)->state, "lost");
    live("asip/servicebus/esp", "distance", kNow + 60s);
    EXPECT_EQ(look("esp", kNow + 61s)->state, "online");
}

TEST_F(BusViewTest, ValidMessageAfterARefusedOne_EndsTheRefusal) {
    retained("asip/servicebus/uno1/$description", "{");
    retained("asip/servicebus/uno1/$state", "sideways\x1b");
    EXPECT_EQ(view_.refused().at("asip/servicebus/uno1/$state"), "not a state: sideways\\x1b");
    EXPECT_EQ(state_of("uno1"), "unknown");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    retained("asip/servicebus/uno1/$state", "online");
    EXPECT_THAT(view_.refused(), IsEmpty());
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_F(BusViewTest, MoreBadTopicsThanAreRemembered_GrowNothing) {
    for (std::size_t i = 0; i < BusView::kMaxRefused + 10; ++i)
        retained("asip/servicebus/uno" + std::to_string(i) + "/$description", "{");
    EXPECT_EQ(view_.refused().size(), BusView::kMaxRefused);
    EXPECT_THAT(view_.names(), IsEmpty());
}

TEST_F(BusViewTest, DescriptionOfAnotherBoard_IsRefusedAndReported) {
    EXPECT_EQ(retained("asip/servicebus/evil/$description", cli::kUno1), "evil");
    EXPECT_EQ(view_.description("evil"), nullptr);
    EXPECT_THAT(view_.refused().at("asip/servicebus/evil/$description"), HasSubstr("another board"));
    EXPECT_THAT(view_.names(), IsEmpty());
}

TEST_F(BusViewTest, Garbage_ChangesNothingAndTheNextGoodOneCounts) {
    retained("asip/servicebus/uno1/$description", "{\"board\":");
    retained("asip/servicebus/a b/$state", "online");
    retained("asip/servicebus", "servicebus");
    retained("elsewhere/uno1/out", "x");
    EXPECT_THAT(view_.names(), IsEmpty());
    EXPECT_EQ(view_.refused().size(), 3U);
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    EXPECT_THAT(view_.names(), ElementsAre("uno1"));
}

TEST_F(BusViewTest, NameWithALineEnd_IsTheBoardItNames) {
    EXPECT_EQ(live("asip/servicebus", "B4\r\n"), "B4");
    EXPECT_EQ(live("asip/servicebus/B4", "Distance\n"), "B4");
    EXPECT_THAT(view_.names(), ElementsAre("B4"));
    EXPECT_EQ(look("B4")->services.at(0).name, "Distance");
}

TEST_F(BusViewTest, LeaseThatRanOut_IsToldOnce) {
    live("asip/servicebus/uno1/$description", cli::kUno1);
    EXPECT_THAT(view_.expired(kNow + 59s), IsEmpty());
    EXPECT_EQ(look("uno1", kNow + 61s)->state, "lost") << "looking judges, too";
    EXPECT_THAT(view_.expired(kNow + 62s), ElementsAre("uno1"));
    EXPECT_THAT(view_.expired(kNow + 63s), IsEmpty());
}

TEST_F(BusViewTest, BrokerAway_NoLeaseRunsOutUntilItIsBack) {
    live("asip/servicebus/uno1/$description", cli::kUno1);
    view_.disconnected();
    EXPECT_EQ(look("uno1", kNow + 600s)->state, "online");
    view_.connected(kNow + 600s);
    EXPECT_EQ(look("uno1", kNow + 605s)->state, "online");
    EXPECT_EQ(look("uno1", kNow + 620s)->state, "lost");
}

TEST_F(BusViewTest, Query_IsAnsweredInPagesThatTheCallerNeverSees) {
    for (int i = 0; i < 2500; ++i)
        live("asip/servicebus", "esp" + std::to_string(i));
    bus::Query query;
    query.limit = 1;
    EXPECT_EQ(view_.boards(query, {kNow, {}}).size(), 2500u);
    query.board = "esp7";
    EXPECT_EQ(view_.boards(query, {kNow, {}}).size(), 1u);
    query.state = {"lost"};
    EXPECT_THAT(view_.boards(query, {kNow, {}}), IsEmpty());
}

}  // namespace
}  // namespace asip::catalogue
