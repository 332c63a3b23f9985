// SPDX-License-Identifier: Apache-2.0
#include "cli/find/profiles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <map>

#include "tests/support/temp_dir.hpp"

namespace asip::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Words = std::vector<std::string>;

class ProfilesTest : public ::testing::Test {
  protected:
    ProfilesTest() {
        EXPECT_TRUE(
            buses_.add({"lab", {{"broker", "mqtts://lab"}, {"user", "ann"}, {"password", "a b # c"}}}));
        EXPECT_TRUE(buses_.add({"shed", {{"broker", "shed:1884"}}}));
    }
    Profiles::Variables variables() const {
        return [this](const std::string& name) {
            const auto found = variables_.find(name);
            return found == variables_.end() ? std::nullopt : std::optional(found->second);
        };
    }
    Words with(const Words& arguments) const {
        const auto all = with_profile(arguments, variables());
        return all ? *all : Words{"error: " + all.error()};
    }

    test::TempDir folder_;
    std::map<std::string, std::string> variables_{{"XDG_CONFIG_HOME", folder_.path().string()}};
    Profiles buses_ = *Profiles::of_user(variables());
};

TEST_F(ProfilesTest, WhatIsAdded_ComesBackAndOnlyItsUserMayReadIt) {
    EXPECT_THAT(buses_.names(), ElementsAre("lab", "shed"));
    EXPECT_EQ(buses_.find("lab")->value("password"), "a b # c");
    struct stat file{};
    ASSERT_EQ(::stat(folder_.file("asip/contexts/lab.conf").c_str(), &file), 0);
    EXPECT_EQ(file.st_mode & 0777U, 0600U);
    EXPECT_THAT(buses_.find("lbb").error(), HasSubstr("did you mean \"lab\""));
    EXPECT_FALSE(buses_.find("../lab"));
    EXPECT_FALSE(buses_.add({"a/b", {}}));
    EXPECT_FALSE(buses_.add({"x", {{"user", "a\nbroker=evil"}}}));
}

TEST_F(ProfilesTest, CurrentOne_IsUsedWhereNothingElseIsNamed) {
    EXPECT_THAT(with({"list"}), ElementsAre("list"));
    ASSERT_TRUE(buses_.use("shed"));
    EXPECT_THAT(with({"list"}), ElementsAre("--broker=shed:1884", "list"));
    EXPECT_THAT(
        with({"--context", "lab", "list"}),
        ElementsAre("--broker=mqtts://lab", "--user=ann", "--password=a b # c", "--context", "lab", "list"));
    EXPECT_THAT(
        with({"--context=lab", "--user=bob", "list"}),
        ElementsAre("--broker=mqtts://lab", "--password=a b # c", "--context=lab", "--user=bob", "list"));
    variables_["ASIP_CONTEXT"] = "lab";
    EXPECT_EQ(with({"list"}).front(), "--broker=mqtts://lab");
    EXPECT_FALSE(buses_.use("nowhere"));
    EXPECT_EQ(buses_.current(), "shed");
    ASSERT_TRUE(buses_.use({}));
    EXPECT_EQ(buses_.current(), "");
}

TEST_F(ProfilesTest, BrokerThatIsNamedOtherwise_GetsNothingOfIt) {
    ASSERT_TRUE(buses_.use("lab"));
    for (const Words& words : {Words{"list", "--broker", "other"}, Words{"--broker=other", "list"},
                               Words{"list", "--credentials", "f"}, Words{"--config", "f", "list"}})
        EXPECT_EQ(with(words), words);
    EXPECT_THAT(with({"--context", "lab", "--broker", "other"}).front(), HasSubstr("leave --broker"));
    variables_["ASIP_BROKER"] = "other";
    EXPECT_THAT(with({"list"}), ElementsAre("list"));
    EXPECT_EQ(with({"--context", "shed", "list"}).front(), "--broker=shed:1884")
        << "what is typed counts first";
}

TEST_F(ProfilesTest, OneThatIsGone_IsAnErrorOnlyWhereItWasAskedFor) {
    ASSERT_TRUE(buses_.use("shed"));
    ASSERT_TRUE(buses_.remove("shed"));
    EXPECT_EQ(buses_.current(), "");
    EXPECT_FALSE(buses_.remove("shed"));
    folder_.write("asip/context", "shed\n");
    EXPECT_THAT(with({"list"}), ElementsAre("list"));
    EXPECT_THAT(with({"--context", "shed"}).front(), HasSubstr("there is no context"));
    variables_.clear();
    EXPECT_THAT(with({"list"}), ElementsAre("list"));
    EXPECT_FALSE(Profiles::of_user(variables()));
}

}  // namespace
}  // namespace asip::cli
