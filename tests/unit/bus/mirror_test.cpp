// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/mirror.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cli/boards.hpp"

namespace asip::bus {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Time kNow{1000s};

class MirrorTest : public ::testing::Test {
  protected:
    std::string retained(const std::string& topic, const std::string& payload) {
        return catalogue_.apply(topic, payload, true, kNow);
    }
    std::string state_of(const std::string& board) const {
        const auto item = catalogue_.board(board, kNow);
        return item ? item->state : "unknown";
    }

    Mirror catalogue_{Topics("asip")};
};

TEST_F(MirrorTest, DescriptionAndState_MakeABoard) {
    retained("asip/servicebus/uno1/$state", "online");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    const auto board = catalogue_.board("uno1", kNow);
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

TEST_F(MirrorTest, OnlineWithoutDescription_IsLost) {
    retained("asip/servicebus/uno1/$state", "online");
    EXPECT_EQ(state_of("uno1"), "lost");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    EXPECT_EQ(state_of("uno1"), "online");
    retained("asip/servicebus/uno1/$description", "");
    EXPECT_EQ(state_of("uno1"), "lost");
}

TEST_F(MirrorTest, WillAndGoodbye_AreReported) {
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    retained("asip/servicebus/uno1/$state", "lost");
    EXPECT_EQ(state_of("uno1"), "lost");
    retained("asip/servicebus/uno1/$state", "offline");
    EXPECT_EQ(state_of("uno1"), "offline");
}

TEST_F(MirrorTest, EverythingEmptied_IsForgotten) {
    retained("asip/servicebus/uno1/$state", "lost");
    EXPECT_EQ(catalogue_.apply("asip/servicebus/uno1/$state", "", false, kNow), "uno1");
    EXPECT_FALSE(catalogue_.board("uno1", kNow));
}

TEST_F(MirrorTest, NamesAlone_MakeABoardThatIsThere) {
    catalogue_.apply("asip/servicebus", "esp", false, kNow);
    catalogue_.apply("asip/servicebus/esp", "distance", false, kNow);
    catalogue_.apply("asip/servicebus/esp", "distance", false, kNow + 2s);
    const auto board = catalogue_.board("esp", kNow + 5s);
    ASSERT_TRUE(board);
    EXPECT_TRUE(board->names_only);
    EXPECT_EQ(board->state, "online");
    ASSERT_EQ(board->services.size(), 1U);
    EXPECT_EQ(board->services[0].name, "distance");
    EXPECT_DOUBLE_EQ(board->age, 3.0);
}

TEST_F(MirrorTest, LeaseRunOut_IsLostUntilTheNextDescription) {
    retained("asip/servicebus/uno1/$state", "online");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    const auto lease = std::chrono::seconds(catalogue_.description("uno1")->lease);
    EXPECT_EQ(catalogue_.board("uno1", kNow + lease - 1s)->state, "online");
    EXPECT_EQ(catalogue_.board("uno1", kNow + lease)->state, "lost");
    catalogue_.apply("asip/servicebus/uno1/$description", cli::kUno1, false, kNow + lease);
    EXPECT_EQ(catalogue_.board("uno1", kNow + lease)->state, "online");
}

TEST_F(MirrorTest, NamesNotHeardForAMinute_AreLost) {
    catalogue_.apply("asip/servicebus", "esp", false, kNow);
    EXPECT_EQ(catalogue_.board("esp", kNow + 59s)->state, "online");
    EXPECT_EQ(catalogue_.board("esp", kNow + 60s)->state, "lost");
    catalogue_.apply("asip/servicebus/esp", "distance", false, kNow + 60s);
    EXPECT_EQ(catalogue_.board("esp", kNow + 61s)->state, "online");
}

TEST_F(MirrorTest, ValidMessageAfterARefusedOne_EndsTheRefusal) {
    retained("asip/servicebus/uno1/$description", "{");
    retained("asip/servicebus/uno1/$state", "sideways\x1b");
    EXPECT_EQ(catalogue_.refused().at("asip/servicebus/uno1/$state"), "not a state: sideways\\x1b");
    EXPECT_EQ(state_of("uno1"), "unknown");
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    retained("asip/servicebus/uno1/$state", "online");
    EXPECT_THAT(catalogue_.refused(), IsEmpty());
    EXPECT_EQ(state_of("uno1"), "online");
}

TEST_F(MirrorTest, MoreBadTopicsThanAreRemembered_GrowNothing) {
    for (std::size_t i = 0; i < Mirror::kMaxRefused + 10; ++i)
        retained("asip/servicebus/uno" + std::to_string(i) + "/$description", "{");
    EXPECT_EQ(catalogue_.refused().size(), Mirror::kMaxRefused);
    EXPECT_THAT(catalogue_.names(), IsEmpty());
}

TEST_F(MirrorTest, DescriptionOfAnotherBoard_IsRefusedAndReported) {
    EXPECT_EQ(retained("asip/servicebus/evil/$description", cli::kUno1), "evil");
    EXPECT_EQ(catalogue_.description("evil"), nullptr);
    EXPECT_THAT(catalogue_.refused().at("asip/servicebus/evil/$description"), HasSubstr("another board"));
    EXPECT_THAT(catalogue_.names(), IsEmpty());
}

TEST_F(MirrorTest, Garbage_ChangesNothingAndTheNextGoodOneCounts) {
    retained("asip/servicebus/uno1/$description", "{\"board\":");
    retained("asip/servicebus/a b/$state", "online");
    retained("asip/servicebus", "servicebus");
    retained("elsewhere/uno1/out", "x");
    EXPECT_THAT(catalogue_.names(), IsEmpty());
    EXPECT_EQ(catalogue_.refused().size(), 2U);
    retained("asip/servicebus/uno1/$description", cli::kUno1);
    EXPECT_THAT(catalogue_.names(), ElementsAre("uno1"));
}

class FilterTest : public ::testing::Test {
  protected:
    bool matches(const Query& query) const {
        return board_matches(query, board_item(description_, "online"), &description_, models_);
    }

    model::Description description_ = *model::parse_description(cli::kUno1);
    model::ModelSet models_ = model::ModelSet::standard();
};

TEST_F(FilterTest, NothingAsked_EverythingMatches) {
    EXPECT_TRUE(matches({}));
}

TEST_F(FilterTest, NamesAndTexts_MatchByPattern) {
    Query query;
    query.board = "uno*";
    query.chip = "*328*";
    EXPECT_TRUE(matches(query));
    query.sketch = "Other*";
    EXPECT_FALSE(matches(query));
}

TEST_F(FilterTest, KindUnitAndCapability_LookAtServicesAndPins) {
    Query query;
    query.kind = {"pixels", "servo"};
    query.unit = "cm";
    query.capability = "pwm";
    EXPECT_FALSE(matches(query)) << "kind and unit hold for one service together";
    query.kind = {"distance"};
    EXPECT_TRUE(matches(query));
    query.unit = "furlong";
    EXPECT_FALSE(matches(query));
}

TEST_F(FilterTest, StateThatItIsNotIn_DoesNotMatch) {
    Query query;
    query.state = {"lost", "offline"};
    EXPECT_FALSE(matches(query));
}

TEST(ModelOf, NewerVersionThanOurs_FallsBackToTheNameWeKnow) {
    model::ServiceInfo service;
    service.name = "distance";
    service.model = "distance@99";
    const auto model = model_of(service, model::ModelSet::standard());
    ASSERT_TRUE(model);
    EXPECT_EQ(model->name, "distance");
    service.model = "teapot@1";
    EXPECT_FALSE(model_of(service, model::ModelSet::standard()));
}

}  // namespace
}  // namespace asip::bus
