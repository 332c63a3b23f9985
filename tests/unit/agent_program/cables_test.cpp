// SPDX-License-Identifier: Apache-2.0
// Where the boards that browsers lend are: places in a folder, over real Unix sockets.
#include "agent/cable/cables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/write.hpp>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "tests/support/loop.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::agent {
namespace {

namespace fs = std::filesystem;
using Protocol = boost::asio::local::stream_protocol;
using link::CableKind;
using testing::HasSubstr;

struct CablesTest : testing::Test {
    void listen() {
        cables.emplace(io, folder,
                       Cables::Handlers{[this](const std::string& place, const std::string&,
                                               std::shared_ptr<const Lent>) { plugged.push_back(place); },
                                        [this](const std::string& place) { left.push_back(place); }});
    }
    std::string why_not() {
        try {
            listen();
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return {};
    }
    void tell(Protocol::socket& gateway, CableKind kind, const std::string& payload) {
        boost::asio::write(gateway, boost::asio::buffer(link::cable_frame(kind, payload)));
    }
    /// The place of the board; empty: it is refused.
    std::string lend(const std::string& by, nlohmann::json more = nlohmann::json::object()) {
        auto& gateway = gateways.emplace_back(io);
        gateway.connect((folder / Cables::kSocket).string());
        more["by"] = by;
        tell(gateway, CableKind::kHello, more.dump());
        const auto before = plugged.size();
        test::run_until(io, [&] { return plugged.size() > before || gateway.available() > 0; });
        return plugged.size() > before ? plugged.back() : std::string();
    }
    bool pull(std::size_t which, const std::string& place) {
        tell(gateways[which], CableKind::kEnd, "closed");
        return test::run_until(io, [&] { return !fs::is_symlink(folder / place); });
    }
    void link(const fs::path& target, const std::string& name) { fs::create_symlink(target, folder / name); }

    test::TempDir work;
    fs::path folder = work.path() / "cables";
    boost::asio::io_context io;
    std::deque<Protocol::socket> gateways;
    std::vector<std::string> plugged, left;
    std::optional<Cables> cables;
};

TEST_F(CablesTest, PlaceOfAnotherLender_IsNotTaken) {
    listen();
    EXPECT_EQ(lend("anna"), "anna");
    EXPECT_EQ(lend("anna"), "anna-2");
    ASSERT_TRUE(pull(1, "anna-2"));
    EXPECT_EQ(lend("anna-2"), "anna-2-1") << "anna-2 has labels and links of anna";
    EXPECT_EQ(lend("anna"), "anna-2") << "the same place, again";
    EXPECT_EQ(lend("gateway"), "gateway-1");
    EXPECT_EQ(lend("gateway-1"), "gateway-1-1");
    // Users whose names make the same place.
    ASSERT_TRUE(pull(0, "anna"));
    EXPECT_EQ(lend("anna "), "anna-3");
    EXPECT_EQ(lend("anna"), "anna");
}

TEST_F(CablesTest, PlacesOfALender_AreTheSameWhoeverCameBefore) {
    listen();
    EXPECT_EQ(lend("anna-2"), "anna-2-1");
    EXPECT_EQ(lend("anna-2"), "anna-2-2");
    EXPECT_EQ(lend("anna"), "anna");
    EXPECT_EQ(lend("anna"), "anna-2");
}

TEST_F(CablesTest, CableThatItsPageConnectsAgain_HasItsPlaceAgain_AlsoWhileTheOldWayStands) {
    const auto cable = [](const char* name) { return nlohmann::json{{"cable", name}}; };
    listen();
    EXPECT_EQ(lend("anna", cable("aa")), "anna");
    EXPECT_EQ(lend("anna", cable("bb")), "anna-2");
    const auto before = fs::read_symlink(folder / "anna-2");
    EXPECT_EQ(lend("anna", cable("bb")), "anna-2");
    EXPECT_NE(fs::read_symlink(folder / "anna-2"), before);
    ASSERT_TRUE(test::run_until(io, [&] { return gateways[1].available() > 0; })) << "the old one is told";
    tell(gateways[1], CableKind::kEnd, "ended");
    test::run_until(io, [&] { return !fs::exists(before); });
    EXPECT_TRUE(fs::is_symlink(folder / "anna-2")) << "the end of the old one is none of the new one";
    // Both come back, in any order.
    ASSERT_TRUE(pull(0, "anna"));
    ASSERT_TRUE(pull(2, "anna-2"));
    EXPECT_EQ(lend("anna", cable("bb")), "anna-2");
    EXPECT_EQ(lend("anna", cable("aa")), "anna");
    EXPECT_EQ(lend("bob", cable("aa")), "bob") << "a name counts for its lender alone";
}

TEST_F(CablesTest, PlaceOfAPupil_IsThatOfTheOneWhoHasItNow_AndNoOtherLendersEver) {
    const auto seat = [](const char* place) { return nlohmann::json{{"place", place}}; };
    listen();
    EXPECT_EQ(lend("student"), "student-0-1");
    EXPECT_EQ(lend("student"), "student-0-2");
    EXPECT_EQ(lend("student-2"), "student-2-1");
    EXPECT_EQ(lend("student-2@1f2e3d4c", seat("student-2")), "student-2");
    EXPECT_EQ(lend("student-2@5a5a5a5a", seat("student-2")), "student-2") << "of the next lesson";
    EXPECT_EQ(lend("student-2@5a5a5a5a", seat("anna")), "");
    EXPECT_EQ(lend("student-2@5a5a5a5a", seat("student-/..")), "");
}

TEST_F(CablesTest, AllPlacesTaken_TheOneThatWaitsLongestIsForgotten) {
    listen();
    for (std::size_t i = 0; i < Cables::kMaxPlaces; ++i)
        ASSERT_EQ(lend("u" + std::to_string(i)), "u" + std::to_string(i));
    EXPECT_EQ(lend("anna"), "");
    ASSERT_TRUE(pull(3, "u3"));
    ASSERT_TRUE(pull(2, "u2"));
    EXPECT_EQ(lend("anna"), "anna");
    EXPECT_EQ(left, std::vector<std::string>{"u3"});
    EXPECT_EQ(lend("u2"), "u2");
}

TEST_F(CablesTest, Folder_WhatTheAgentDidNotMakeStays) {
    fs::create_directory(folder);
    fs::permissions(folder, fs::perms::owner_all);
    work.write("file", "mine");
    link(work.path() / "file", "bob");
    link("/dev/pts/12345", "left-over");
    std::ofstream(folder / "carl") << "a file";
    listen();
    EXPECT_FALSE(fs::is_symlink(folder / "left-over"));
    EXPECT_EQ(lend("bob"), "") << "no room for its port";
    EXPECT_EQ(lend("carl"), "");
    EXPECT_EQ(lend("dora"), "dora");
    cables.reset();
    EXPECT_FALSE(fs::is_symlink(folder / "dora"));
    EXPECT_TRUE(fs::is_symlink(folder / "bob"));
    EXPECT_TRUE(fs::is_regular_file(folder / "carl"));
}

TEST_F(CablesTest, FolderWhereOthersMayWrite_IsRefusedAndStaysAsItIs) {
    fs::create_directory(folder);
    link("/dev/pts/12345", "of-another");
    for (const auto write : {fs::perms::group_write, fs::perms::others_write}) {
        fs::permissions(folder, fs::perms::owner_all | write);
        EXPECT_THAT(why_not(), HasSubstr("others may write in the folder")) << static_cast<int>(write);
    }
    EXPECT_TRUE(fs::is_symlink(folder / "of-another"));
    folder = work.path() / "link";
    fs::create_symlink(work.path() / "cables", folder);
    EXPECT_THAT(why_not(), HasSubstr("it is no folder"));
    folder = "/proc/1";  // of root
    if (::geteuid() == 0) {
        folder = work.path() / "cables";
        ASSERT_EQ(::chown(folder.c_str(), 12345, 12345), 0);
    }
    EXPECT_THAT(why_not(), HasSubstr("the folder is of another user"));
}

TEST_F(CablesTest, FileInPlaceOfTheSocket_IsKept) {
    fs::create_directory(folder);
    fs::permissions(folder, fs::perms::owner_all);
    std::ofstream(folder / Cables::kSocket) << "a file";
    EXPECT_THAT(why_not(), HasSubstr("something else has this name"));
    EXPECT_TRUE(fs::is_regular_file(folder / Cables::kSocket));
    fs::remove(folder / Cables::kSocket);
    {
        Protocol::acceptor killed(io, (folder / Cables::kSocket).string());
    }
    EXPECT_EQ(why_not(), "");
    EXPECT_EQ(lend("anna"), "anna");
}

}  // namespace
}  // namespace asip::agent
