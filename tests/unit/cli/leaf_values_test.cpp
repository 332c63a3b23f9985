// SPDX-License-Identifier: Apache-2.0
#include "cli/events/leaf_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/model/model_set.hpp"

namespace asip::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const model::ServiceModel& model_named(const char* name) {
    return *model::ModelSet::standard().find(name);
}

std::vector<std::string> shown(const char* kind, const std::string& field, const char* event) {
    const auto choice = choose_field(model_named(kind), field);
    EXPECT_TRUE(choice) << choice.error();
    std::vector<std::string> result;
    for (const auto& leaf : leaf_values(model_named(kind), *choice->event, Json::parse(event)))
        if (choice->takes(leaf.path)) result.push_back(leaf.path + "=" + leaf.text());
    return result;
}

TEST(LeafValues, EachElement_HasTheUnitOfTheModel) {
    EXPECT_THAT(shown("distance", "", "[42,118]"), ElementsAre("0=42 cm", "1=118 cm"));
    EXPECT_THAT(shown("distance", "distance/1", "[42,118]"), ElementsAre("1=118 cm"));
    EXPECT_THAT(shown("distance", "0", "[42,118]"), ElementsAre("0=42 cm"));
    EXPECT_THAT(shown("distance", "7", "[42,118]"), ElementsAre());
}

TEST(LeafValues, DistanceWithoutAnEcho_IsNone) {
    EXPECT_THAT(shown("distance", "", "[0,118]"), ElementsAre("0=none", "1=118 cm"));
}

TEST(LeafValues, FieldsOfElements_AreFoundByName) {
    const auto* event = R"([{"pulse":10,"count":3},{"pulse":12,"count":4}])";
    EXPECT_THAT(shown("encoders", "count", event),
                ElementsAre(HasSubstr("0.count=3"), HasSubstr("1.count=4")));
}

TEST(LeafValues, ValuesByKey_KeepTheirKeys) {
    EXPECT_THAT(shown("io", "analog/3", R"({"0":320,"3":17})"), ElementsAre("3=17"));
}

TEST(ChooseField, Unknown_IsRefusedWithTheNearest) {
    const auto choice = choose_field(model_named("distance"), "distnace");
    ASSERT_FALSE(choice);
    EXPECT_THAT(choice.error(), HasSubstr("did you mean \"distance\"?"));
}

TEST(AskingCommand, OnlyWithoutArguments_CanAsk) {
    const auto& distance = model_named("distance");
    ASSERT_NE(asking_command(distance, distance.events[0]), nullptr);
    EXPECT_EQ(asking_command(distance, distance.events[0])->name, "measure");
    const auto& io = model_named("io");
    EXPECT_EQ(asking_command(io, *io.event_named("digital")), nullptr);
}

}  // namespace
}  // namespace asip::cli
