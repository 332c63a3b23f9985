// SPDX-License-Identifier: Apache-2.0
#include "agent/describe/label_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/support/temp_dir.hpp"

namespace asip::agent {
namespace {

using testing::HasSubstr;

const LabelsToKeep kLab{{{{"room", "lab"}}, {}, {}}};

struct LabelFilesTest : testing::Test {
    std::string content(const std::string& name) const {
        std::ifstream stream(folder.path() / "labels" / name);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    void write(const std::string& text) {
        std::filesystem::create_directories(folder.path() / "labels");
        folder.write("labels/uno1.json", text);
    }

    test::TempDir folder;
    LabelFiles files{folder.path()};
};

struct Damaged : LabelFilesTest, testing::WithParamInterface<std::string> {};

TEST_P(Damaged, IsToldWithItsPlaceAndPutAsideByTheNextChange) {
    write(GetParam());
    const auto read = files.load("uno1");
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error(), HasSubstr(folder.file("labels/uno1.json") + ": "));
    EXPECT_THAT(read.error(), HasSubstr("mend it and start the agent again, or set labels anew"));
    const auto saved = files.save("uno1", kLab);
    ASSERT_TRUE(saved) << saved.error();
    EXPECT_EQ(*saved, folder.file("labels/uno1.json.damaged"));
    EXPECT_EQ(content("uno1.json.damaged"), GetParam());
    EXPECT_EQ(files.load("uno1").value(), kLab.labels);
}

INSTANTIATE_TEST_SUITE_P(Content, Damaged,
                         testing::Values("", "no JSON", R"({"labels":{"room":"la)", R"(["room"])",
                                         R"({"labels":{"room":7}})", R"({"labels":["room"]})",
                                         R"({"labels":{"my room":"x"}})", "\xff\xfe",
                                         std::string(70'000, ' ')));

TEST_F(LabelFilesTest, WhatIsNoFile_IsPutAsideToo) {
    std::filesystem::create_directories(folder.path() / "labels/uno1.json");
    ASSERT_FALSE(files.load("uno1"));
    EXPECT_EQ(files.save("uno1", kLab).value(), folder.file("labels/uno1.json.damaged"));
    EXPECT_EQ(files.load("uno1").value(), kLab.labels);
}

TEST_F(LabelFilesTest, WhatWasPutAsideBefore_IsNeverOverwritten) {
    for (int number = 1; number <= 9; ++number) {
        write("damaged " + std::to_string(number));
        ASSERT_TRUE(files.save("uno1", kLab));
    }
    EXPECT_EQ(content("uno1.json.damaged"), "damaged 1");
    EXPECT_EQ(content("uno1.json.damaged-9"), "damaged 9");
    write("damaged 10");
    const auto refused = files.save("uno1", kLab);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error(), HasSubstr("mend or remove them"));
    EXPECT_EQ(content("uno1.json"), "damaged 10");
}

TEST_F(LabelFilesTest, MendedWhileTheAgentRan_IsPutAsideAndNotOverwritten) {
    write(R"({"labels":{"floor":"2"}})");
    auto keep = kLab;
    keep.unknown_before = true;
    EXPECT_EQ(files.save("uno1", keep).value(), folder.file("labels/uno1.json.damaged"));
    EXPECT_EQ(files.save("uno1", kLab).value(), "") << "what the agent wrote is overwritten";
}

}  // namespace
}  // namespace asip::agent
