// SPDX-License-Identifier: Apache-2.0
#include "asip/program/kept_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "tests/support/temp_dir.hpp"

namespace asip::program {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string text_of(const fs::path& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(KeptFile, MissingFolders_AreMadeForTheOwnerAlone) {
    const test::TempDir folder;
    const auto file = folder.path() / "a/b/desk.json";
    ASSERT_TRUE(keep_file(file, "one"));
    ASSERT_TRUE(keep_file(file, "two"));
    EXPECT_EQ(text_of(file), "two");
    struct stat status{};
    ASSERT_EQ(::stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777u, 0600u);
    ASSERT_EQ(::stat((folder.path() / "a").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777u, 0700u);
    EXPECT_FALSE(fs::exists(file.string() + ".new"));
}

TEST(KeptFile, Dropped_IsGone) {
    const test::TempDir folder;
    ASSERT_TRUE(keep_file(folder.file("desk.json"), "one"));
    ASSERT_TRUE(drop_file(folder.file("desk.json")));
    EXPECT_FALSE(fs::exists(folder.file("desk.json")));
    EXPECT_TRUE(drop_file(folder.file("desk.json"))) << "there is none";
}

TEST(KeptFile, WhatAKilledProgramLeft_IsReplaced) {
    const test::TempDir folder;
    folder.write("desk.json.new", "half of it, and longer than the whole");
    ASSERT_TRUE(keep_file(folder.file("desk.json"), "whole"));
    EXPECT_EQ(text_of(folder.file("desk.json")), "whole");
}

TEST(KeptFile, LinkInThePlaceOfTheNewFile_IsNotFollowed) {
    const test::TempDir folder;
    const auto other = folder.write("other", "untouched");
    fs::create_symlink(other, folder.file("desk.json.new"));
    ASSERT_TRUE(keep_file(folder.file("desk.json"), "whole"));
    EXPECT_EQ(text_of(folder.file("desk.json")), "whole");
    EXPECT_EQ(text_of(other), "untouched");
}

TEST(KeptFile, PipeInThePlaceOfTheNewFile_HoldsNothingUp) {
    const test::TempDir folder;
    ASSERT_EQ(::mkfifo(folder.file("desk.json.new").c_str(), 0600), 0);
    ASSERT_TRUE(keep_file(folder.file("desk.json"), "whole"));
    EXPECT_EQ(text_of(folder.file("desk.json")), "whole");
}

TEST(KeptFile, FolderThatCannotBe_IsNamed) {
    const test::TempDir folder;
    const auto file = folder.write("file", "");
    const auto kept = keep_file(fs::path(file) / "desk.json", "x");
    ASSERT_FALSE(kept);
    EXPECT_THAT(kept.error(), HasSubstr("cannot be written"));
    EXPECT_THAT(kept.error(), HasSubstr(file));
}

}  // namespace
}  // namespace asip::program
