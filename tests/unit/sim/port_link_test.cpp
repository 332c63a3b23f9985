// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>

#include "sim/program/pty.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::sim {
namespace {

namespace fs = std::filesystem;

TEST(PortLink, LeftByAProgramThatWasKilled_IsMadeAnew) {
    const test::TempDir folder;
    const fs::path link = folder.file("board");
    const auto port = Pty::open().value();
    for (const auto& target : {std::string("/dev/pts/none"), port.path()}) {
        fs::create_symlink(target, link);
        {
            const auto made = PortLink::create(link, port.path());
            ASSERT_TRUE(made) << target << ": " << made.error();
            EXPECT_EQ(fs::read_symlink(link), port.path());
        }
        EXPECT_FALSE(fs::is_symlink(link));
    }
}

TEST(PortLink, WhatBelongsToOthers_IsLeftAlone) {
    const test::TempDir folder;
    const fs::path link = folder.file("board");
    const auto port = Pty::open().value();
    const auto of_others = Pty::open().value();
    fs::create_symlink(of_others.path(), link);
    EXPECT_FALSE(PortLink::create(link, port.path()));
    EXPECT_EQ(fs::read_symlink(link), of_others.path());
    const fs::path file = folder.write("precious", "text");
    EXPECT_FALSE(PortLink::create(file, port.path()));
    EXPECT_TRUE(fs::is_regular_file(file));
}

}  // namespace
}  // namespace asip::sim
