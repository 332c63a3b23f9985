// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/clashes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace asip::generate {
namespace {

using model::ModelSet;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Clashes clashes_of(const std::string& text) {
    const auto model = model::parse_service_model(text);
    EXPECT_TRUE(model) << (model ? "" : model.error());
    return find_clashes(*model, ModelSet::standard());
}

TEST(Clashes, StandardModels_HaveNoFaultAmongThemselves) {
    for (const auto& model : ModelSet::standard().all())
        EXPECT_THAT(find_clashes(*model, ModelSet::standard()).faults, IsEmpty()) << model->name;
}

TEST(Clashes, LetterAlone_IsANote) {
    const auto clashes =
        clashes_of(R"({"name":"pump","version":1,"id":"P","match":["Pump"],"title":"Pumps"})");
    EXPECT_THAT(clashes.faults, IsEmpty());
    EXPECT_THAT(clashes.notes,
                ElementsAre("letter P is also that of pixels, pressure: one board cannot have both"));
}

TEST(Clashes, NameThatAStandardModelTakes_IsAFault) {
    const auto clashes =
        clashes_of(R"({"name":"pump","version":1,"id":"P","match":["Pump pressure"],"title":"Pumps"})");
    EXPECT_THAT(clashes.faults, ElementsAre(HasSubstr("\"Pump pressure\" is taken for pressure")));
}

TEST(Clashes, LetterOfThePins_IsAFault) {
    const auto clashes = clashes_of(R"({"name":"ink","version":1,"id":"I","match":["Ink"],"title":"Ink"})");
    EXPECT_THAT(clashes.faults, ElementsAre(HasSubstr("I is the letter of the pins")));
}

TEST(Clashes, NameOfAStandardModel_IsANote) {
    const auto clashes = clashes_of(R"({"name":"servo","version":2,"id":"S","title":"Other servos"})");
    EXPECT_THAT(clashes.faults, IsEmpty());
    EXPECT_THAT(clashes.notes,
                ElementsAre(HasSubstr("replaces the model servo@1"), HasSubstr("no \"match\"")));
}

}  // namespace
}  // namespace asip::generate
