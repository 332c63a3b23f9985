// SPDX-License-Identifier: Apache-2.0
// `asipctl secure init` for the broker of a machine: it says what it changes, asks, and can be undone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "tests/support/child_process.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/support/terminal.hpp"

namespace asip::test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Not;
using Words = std::vector<std::string>;

/// A machine whose Mosquitto lets in everybody, by the file that the packages come with.
class SecuredSystem : public ::testing::Test {
  protected:
    SecuredSystem() {
        fs::create_directory(configurations());
        place_.write("conf.d/asip.conf", kOpen);
    }
    std::string configurations() const { return place_.file("conf.d"); }
    std::string folder() const { return place_.file("bus"); }
    Words secure(Words words) const {
        words.insert(words.begin(), {ASIP_TEST_ASIPCTL, "secure"});
        words.insert(words.end(), {"--dir", folder()});
        return words;
    }
    Words init(const Words& more = {}) const {
        auto words = secure({"init", "--mosquitto", configurations(), "--host", "localhost"});
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    /// Everything of the machine: each file with its text.
    std::map<std::string, std::string> files() const {
        std::map<std::string, std::string> all;
        for (const auto& entry : fs::recursive_directory_iterator(place_.path())) {
            if (!entry.is_regular_file()) continue;
            std::ifstream in(entry.path());
            all[fs::relative(entry.path(), place_.path()).string()] = {std::istreambuf_iterator<char>(in),
                                                                       {}};
        }
        return all;
    }
    void expect_secured() const {
        EXPECT_THAT(files(), Contains(Key("conf.d/asip-secured.conf")));
        EXPECT_THAT(files(), Contains(Key("conf.d/asip.conf.open")));
        EXPECT_THAT(files(), Not(Contains(Key("conf.d/asip.conf"))));
    }

    static constexpr const char* kOpen = "listener 1883\nallow_anonymous true\n";
    TempDir place_;
};

TEST_F(SecuredSystem, WithoutATerminal_ChangesNothingAndSaysHow) {
    const auto before = files();
    const auto refused = run(init());
    EXPECT_EQ(refused.status, 2);
    for (const char* part : {"conf.d/asip-secured.conf: port 8883", "asip.conf, which lets in everybody",
                             "--yes: do it", "--dry-run: only say it"})
        EXPECT_THAT(refused.errors, HasSubstr(part));
    EXPECT_THAT(refused.errors, Not(HasSubstr("?"))) << "each step has a line";
    EXPECT_EQ(files(), before);
}

TEST_F(SecuredSystem, DryRun_SaysWhatItWouldDoAndChangesNothing) {
    const auto before = files();
    const auto said = run(init({"--dry-run"}));
    EXPECT_EQ(said.status, 0) << said.errors;
    EXPECT_THAT(said.output, HasSubstr("keep authority, keys and passwords in " + folder()));
    EXPECT_THAT(said.output, HasSubstr("asip.conf, which lets in everybody, to"));
    EXPECT_EQ(files(), before);
}

TEST_F(SecuredSystem, OnATerminal_AsksAndTakesNothingButYesForAYes) {
    const auto before = files();
    for (const char* answer : {"n\n", "\n", "nope\n", "\x04"}) {
        TerminalProcess asked(init());
        ASSERT_TRUE(asked.shows("Continue\\? \\[y/N\\]")) << asked.written();
        asked.type(answer);
        EXPECT_EQ(asked.wait_exit(), 0) << answer;
        EXPECT_EQ(files(), before) << answer;
    }
    TerminalProcess killed(init());
    ASSERT_TRUE(killed.shows("Continue"));
    killed.type("\x03");
    EXPECT_NE(killed.wait_exit(), 0);
    EXPECT_EQ(files(), before);

    TerminalProcess asked(init());
    ASSERT_TRUE(asked.shows("Continue"));
    EXPECT_EQ(files(), before) << "before the answer";
    asked.type("y\n");
    EXPECT_EQ(asked.wait_exit(), 0) << asked.written();
    expect_secured();
}

TEST_F(SecuredSystem, Yes_AsksNothing_AndUndoMakesTheMachineAsItWas) {
    ASSERT_EQ(run(init({"--yes"})).status, 0);
    expect_secured();
    const auto secured = files();
    const auto again = run(init());
    EXPECT_EQ(again.status, 0) << "nothing is left to be asked: " << again.errors;
    EXPECT_EQ(files(), secured);

    const auto said = run(secure({"undo", "--dry-run"}));
    EXPECT_EQ(said.status, 0) << said.errors;
    EXPECT_THAT(said.output, HasSubstr("will remove"));
    EXPECT_EQ(files(), secured);

    const auto undone = run(secure({"undo"}));
    EXPECT_EQ(undone.status, 0) << undone.errors;
    EXPECT_THAT(undone.output, HasSubstr("systemctl restart mosquitto"))
        << "the services of a machine are those of its own bus";
    const auto after = files();
    EXPECT_EQ(after.at("conf.d/asip.conf"), kOpen);
    EXPECT_FALSE(after.contains("conf.d/asip-secured.conf"));
    EXPECT_FALSE(after.contains("conf.d/asip.conf.open"));
    EXPECT_TRUE(after.contains("bus/bus.json")) << "the bus itself is kept";
    EXPECT_EQ(run(secure({"undo"})).status, 0) << "twice";

    ASSERT_EQ(run(init({"--yes"})).status, 0);
    EXPECT_EQ(files(), secured) << "the same bus, with the same keys";
}

TEST_F(SecuredSystem, UndoOfABusInAFolder_HasNothingToTakeBack) {
    ASSERT_EQ(run(secure({"init", "--host", "localhost"})).status, 0);
    const auto refused = run(secure({"undo"}));
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.errors, HasSubstr("nothing was changed outside of"));
}

}  // namespace
}  // namespace asip::test
