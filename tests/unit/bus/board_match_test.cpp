// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/board_match.hpp"

#include <gtest/gtest.h>

#include "tests/unit/cli/boards.hpp"

namespace asip::bus {
namespace {

class FilterTest : public ::testing::Test {
  protected:
    bool matches(const Query& query) const {
        return board_matches(query, cli::announced(), &description_, models_);
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
