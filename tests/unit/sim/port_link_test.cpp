// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

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

TEST(PortLink, OlderThanTheTerminalThatHasItsNumberNow_IsMadeAnew) {
    const test::TempDir folder;
    const fs::path link = folder.file("board");
    const auto port = Pty::open().value();
    const auto of_others = Pty::open().value();
    fs::create_symlink(of_others.path(), link);
    const timespec long_ago[]{{1, 0}, {1, 0}};
    ASSERT_EQ(::utimensat(AT_FDCWD, link.c_str(), long_ago, AT_SYMLINK_NOFOLLOW), 0);
    const auto made = PortLink::create(link, port.path());
    ASSERT_TRUE(made) << made.error();
    EXPECT_EQ(fs::read_symlink(link), port.path());
    EXPECT_TRUE(fs::exists(of_others.path()));
}

TEST(PortLink, WhatBelongsToOthers_IsLeftAlone) {
    const test::TempDir folder;
    const fs::path link = folder.file("board");
    const auto port = Pty::open().value();
    const auto of_others = Pty::open().value();
    fs::create_symlink(of_others.path(), link);
    EXPECT_FALSE(PortLink::create(link, port.path()));
    EXPECT_EQ(fs::read_symlink(link), of_others.path());
    for (const fs::path target : {"/dev/null", "/dev/serial/by-id/unplugged"}) {
        fs::remove(link);
        fs::create_symlink(target, link);
        EXPECT_FALSE(PortLink::create(link, port.path())) << target;
        EXPECT_EQ(fs::read_symlink(link), target);
    }
    const fs::path file = folder.write("precious", "text");
    EXPECT_FALSE(PortLink::create(file, port.path()));
    EXPECT_TRUE(fs::is_regular_file(file));
}

}  // namespace
}  // namespace asip::sim
