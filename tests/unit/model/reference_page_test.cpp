// SPDX-License-Identifier: Apache-2.0
#include "asip/model/reference_page.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace asip::model {
namespace {

TEST(ReferencePage, CommittedPage_IsThatOfTheModels) {
    const std::string path = ASIP_SOURCE_DIR "/docs/services.md";
    const auto page = reference_page(ModelSet::standard());
    if (std::getenv("ASIP_REGENERATE") != nullptr) std::ofstream(path) << page;
    std::ifstream file(path);
    const std::string committed{std::istreambuf_iterator<char>(file), {}};
    EXPECT_TRUE(committed == page) << path
                                   << " is out of date: run the model tests with ASIP_REGENERATE=1 set";
}

}  // namespace
}  // namespace asip::model
