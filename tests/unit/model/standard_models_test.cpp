// SPDX-License-Identifier: Apache-2.0
// Every standard model, and the one that docs/service-models.md teaches with, against its own examples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "asip/model/example_check.hpp"
#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

/// The first JSON block of the page.
ModelPtr taught_model() {
    std::ifstream file(ASIP_SOURCE_DIR "/docs/service-models.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    constexpr std::string_view kOpen = "```json\n";
    const auto begin = page.find(kOpen) + kOpen.size();
    const auto model = parse_service_model(page.substr(begin, page.find("```", begin) - begin));
    if (!model) throw std::runtime_error("docs/service-models.md: " + model.error());
    return std::make_shared<const ServiceModel>(*model);
}

std::vector<ModelPtr> tested_models() {
    auto models = ModelSet::standard().all();
    models.push_back(taught_model());
    return models;
}

class StandardModel : public testing::TestWithParam<ModelPtr> {
  protected:
    const ModelPtr model_ = GetParam();
    const std::vector<ModelExample> examples_ = examples(*model_);
};

TEST_P(StandardModel, EachExample_IsTrue) {
    for (const auto& example : examples_) {
        const auto checked = check_example(*model_, example);
        EXPECT_TRUE(checked) << checked.error();
    }
}

TEST_P(StandardModel, Examples_CoverEachEventEachCommandAndAnError) {
    EXPECT_THAT(missing_examples(*model_), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(All, StandardModel, testing::ValuesIn(tested_models()),
                         [](const auto& each) { return each.param->name; });

}  // namespace
}  // namespace asip::model
