// SPDX-License-Identifier: Apache-2.0
// Every standard model against its own examples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/model/example_check.hpp"
#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

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

INSTANTIATE_TEST_SUITE_P(All, StandardModel, testing::ValuesIn(ModelSet::standard().all()),
                         [](const auto& each) { return each.param->name; });

}  // namespace
}  // namespace asip::model
