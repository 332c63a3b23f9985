// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "cli/backup/items.hpp"
#include "cli/backup/sealed.hpp"

namespace asip::cli {
namespace {

BackupItem item(Place place, const std::string& path, mode_t mode = 0644) {
    BackupItem made{place, path, mode};
    made.size = 3;
    return made;
}

bool may_have(const BackupItem& made, bool sealed = true) {
    const auto begin = to_text("made here", {made});
    return read_list(begin, begin.size() + made.size, sealed).has_value();
}

TEST(BackupList, IsReadAsItWasWritten) {
    const auto begin = to_text("made here", {item(Place::kEtc, "boards/a b:1.env"),
                                             item(Place::kState, "links/lamp/door.json", 0600)});
    const auto list = read_list(begin + "aaabbb", begin.size() + 6, true);
    ASSERT_TRUE(list);
    EXPECT_EQ(list->about, "made here");
    ASSERT_EQ(list->items.size(), 2U);
    EXPECT_EQ(list->items[0].path, "boards/a b:1.env");
    EXPECT_EQ(list->items[1].mode, 0600U);
    EXPECT_EQ(list->items[1].at, begin.size() + 3);
}

TEST(BackupList, PathsThatLeadElsewhere_AreRefused) {
    for (const char* path :
         {"", "/etc/passwd", "../passwd", "boards/../../passwd", "boards/", "a//b", ".hidden", "boards/.x",
          "a/b/c/d/e", "a\tb", "bus/broker/mosquitto.db", "bus/broker/x/passwords"})
        EXPECT_FALSE(may_have(item(Place::kEtc, path))) << path;
    for (const char* path :
         {"x", "labels/x", "labels/a/x.json", "../labels/x.json", "history.db-wal", "links/x.json"})
        EXPECT_FALSE(may_have(item(Place::kState, path, 0600))) << path;
    for (const char* path : {"mosquitto.conf", "own.conf", "asip.conf/x"})
        EXPECT_FALSE(may_have(item(Place::kMosquitto, path))) << path;
    EXPECT_FALSE(may_have(item(Place::kDashboard, "a+")));
    EXPECT_FALSE(may_have(item(Place::kEtc, "asip.conf", 04755))) << "modes that make it a program";
}

TEST(BackupList, KeysInAFileWithoutAPassphrase_AreRefused) {
    for (const char* path : {"bus/bus.json", "bus/ca.crt", "credentials/gateway.credentials"}) {
        EXPECT_TRUE(may_have(item(Place::kEtc, path))) << path;
        EXPECT_FALSE(may_have(item(Place::kEtc, path), false)) << path;
    }
    EXPECT_FALSE(may_have(item(Place::kEtc, "tokens", 0640), false));
    EXPECT_TRUE(may_have(item(Place::kEtc, "asip.conf"), false));
}

TEST(BackupList, SizesThatAreNotThere_AreRefused) {
    const auto begin = to_text("made here", {item(Place::kEtc, "a"), item(Place::kEtc, "b")});
    EXPECT_TRUE(read_list(begin, begin.size() + 6, true));
    for (const std::size_t bytes : {0U, 2U, 3U, 5U, 7U})
        EXPECT_FALSE(read_list(begin, begin.size() + bytes, true)) << bytes;
    EXPECT_FALSE(may_have([] {
        auto large = item(Place::kEtc, "a");
        large.size = kMaxFileBytes + 1;
        return large;
    }()));
    const auto twice = to_text("made here", {item(Place::kEtc, "a"), item(Place::kEtc, "a")});
    EXPECT_FALSE(read_list(twice, twice.size() + 6, true));
    for (const char* text :
         {"", "\n\n", "made\netc 0 0 0\n\n", "made\netc 0 0 -1 a\n\n", "made\netc 0 -1 0 a\n\n",
          "made\nroot 0 0 0 a\n\n", "made\netc 0 0 0  a\n\n", "made\netc 0 0 0 a"}) {
        const auto read = read_list(text, std::string_view(text).size(), true);
        EXPECT_TRUE(!read || read->items.empty() || read->items[0].path == " a") << text;
    }
}

}  // namespace
}  // namespace asip::cli
