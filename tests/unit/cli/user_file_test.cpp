// SPDX-License-Identifier: Apache-2.0
#include "cli/find/user_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "tests/support/temp_dir.hpp"

namespace asip::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

class UserFileTest : public ::testing::Test {
  protected:
    Words with(const Words& arguments) const {
        const auto all = with_user_file(arguments, [this](const std::string& name) {
            const auto found = variables_.find(name);
            return found == variables_.end() ? std::nullopt : std::optional(found->second);
        });
        return all ? *all : Words{"error: " + all.error()};
    }

    void write(const std::string& folder, const std::string& text) const {
        const auto path = folder_.path() / folder / "asip";
        std::filesystem::create_directories(path);
        std::ofstream(path / "asipctl.conf") << text;
    }

    test::TempDir folder_;
    std::map<std::string, std::string> variables_{{"HOME", folder_.path().string()}};
};

TEST_F(UserFileTest, ItsLines_StandInFrontOfWhatIsTyped) {
    EXPECT_THAT(with({"list"}), ElementsAre("list"));
    write(".config", "broker = \"shed:1884\"\n[asip-agent]\nuser = bo\n[asipctl]\nuser=ann\n");
    EXPECT_THAT(with({"list"}), ElementsAre("--broker=shed:1884", "--user=ann", "list"));
    EXPECT_THAT(with({"list", "--user", "bob"}), ElementsAre("--broker=shed:1884", "list", "--user", "bob"));
    variables_["XDG_CONFIG_HOME"] = folder_.path() / "elsewhere";
    EXPECT_THAT(with({"list"}), ElementsAre("list"));
    write("elsewhere", "nonsense\n");
    EXPECT_THAT(with({"list"}).front(), HasSubstr("asipctl.conf:1"));
    variables_.clear();
    EXPECT_THAT(with({"list"}), ElementsAre("list"));
}

TEST_F(UserFileTest, BusThatIsNamedOtherwise_GetsNothingOfIt) {
    write(".config", "broker = lab\npassword-file = /secret\n");
    for (const Words& words : {Words{"list", "--broker", "other"}, Words{"--broker=other", "list"},
                               Words{"list", "--credentials", "f"}, Words{"--config", "f", "list"}})
        EXPECT_EQ(with(words), words);
    for (const char* variable : {"ASIP_BROKER", "ASIP_CREDENTIALS", "ASIP_CONFIG"}) {
        variables_[variable] = "other";
        EXPECT_THAT(with({"list"}), ElementsAre("list")) << variable;
        variables_.erase(variable);
    }
}

}  // namespace
}  // namespace asip::cli
