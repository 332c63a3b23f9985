// SPDX-License-Identifier: Apache-2.0
// What the shell makes of a line, what it shows beside it, and what it keeps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "cli/command_line.hpp"
#include "cli/shell/line_history.hpp"
#include "cli/shell/shell_values.hpp"
#include "cli/shell/shell_words.hpp"
#include "tests/support/temp_dir.hpp"

namespace asip::cli {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Line = std::vector<std::string>;

class ShellWordsTest : public ::testing::Test {
  protected:
    std::string expanded(const std::string& line) const {
        std::string text;
        for (const auto& word : expand_words(line_.app(), shell_words(line).value(), "desk"))
            text += (text.empty() ? "" : " ") + word;
        return text;
    }
    Line completed(const std::string& typed) const {
        return complete_shell(line_.app(), typed, "desk", names_);
    }

    CommandLine line_{all_verbs()};
    NameSources names_{
        [] { return Line{"desk", "lamp"}; },
        [](const std::string& board) { return board == "desk" ? Line{"distance", "servo"} : Line{}; },
        [](const std::string& board, const std::string& service) {
            return board == "desk" && service == "distance" ? Line{"measure", "report"} : Line{};
        },
        [](const std::string& board, const std::string& service) {
            return board == "desk" && service == "distance" ? Line{"distance"} : Line{};
        },
        [] { return Line{"distance"}; },
        [] { return Line{"cm"}; },
        [] { return Line{"room=lab"}; }};
};

TEST_F(ShellWordsTest, AServiceFirst_IsSent) {
    EXPECT_EQ(expanded("distance measure"), "send desk/distance measure");
    EXPECT_EQ(expanded("servo write 0 90 -o json"), "send desk/servo write 0 90 -o json");
    EXPECT_EQ(expanded("send servo write 0 90"), "send desk/servo write 0 90");
    EXPECT_EQ(expanded("record walk.jsonl -n 3"), "record walk.jsonl -n 3 desk");
    EXPECT_EQ(expanded("record walk.jsonl lamp"), "record walk.jsonl lamp");
    EXPECT_EQ(expanded("send --raw S,W,0,90"), "send desk --raw S,W,0,90");
    EXPECT_EQ(expanded("label room=lab"), "label desk room=lab");
    EXPECT_EQ(expanded("label room-"), "label desk room-");
    EXPECT_EQ(expanded("label servo name=arm"), "label desk/servo name=arm");
    EXPECT_EQ(expanded("label"), "label desk");
    EXPECT_EQ(expanded("nosuch"), "send desk/nosuch");
}

TEST_F(ShellWordsTest, AVerbFirst_IsForTheBoard) {
    EXPECT_EQ(expanded("get distance"), "get desk/distance");
    EXPECT_EQ(expanded("get distance/0 --raw"), "get desk/distance/0 --raw");
    EXPECT_EQ(expanded("get --raw distance"), "get --raw desk/distance");
    EXPECT_EQ(expanded("get"), "get desk") << "all of its values";
    EXPECT_EQ(expanded("pin 13 high"), "pin desk 13 high");
    EXPECT_EQ(expanded("pin"), "pin desk");
    EXPECT_EQ(expanded("subscribe distance servo -n 3"), "subscribe desk/distance desk/servo -n 3");
    EXPECT_EQ(expanded("subscribe -n 3"), "subscribe desk -n 3");
    EXPECT_EQ(expanded("show"), "show desk");
    EXPECT_EQ(expanded("wait --for online"), "wait desk --for online");
    EXPECT_EQ(expanded("events"), "events desk");
    EXPECT_EQ(expanded("ping -n 1"), "ping desk -n 1");
    EXPECT_EQ(expanded("stop"), "stop desk");
    EXPECT_EQ(expanded("stop --all"), "stop --all");
}

TEST_F(ShellWordsTest, WhatIsOfNoBoard_AndTheBoardItself_Stay) {
    EXPECT_EQ(expanded("list -o json"), "list -o json");
    EXPECT_EQ(expanded("model servo"), "model servo");
    EXPECT_EQ(expanded("--help"), "--help");
    EXPECT_EQ(expanded("show desk/servo"), "show desk/servo");
    EXPECT_EQ(expanded("pin desk 13"), "pin desk 13");
    EXPECT_EQ(expanded("events lamp"), "events lamp");
    EXPECT_EQ(expanded(""), "");
}

TEST_F(ShellWordsTest, LinesThatCannotBe_AreRefusedWithTheReason) {
    EXPECT_THAT(shell_words("a 'b").error(), HasSubstr("never closed"));
    EXPECT_THAT(shell_words(std::string("a\0b", 3)).error(), HasSubstr("control characters"));
    EXPECT_THAT(shell_words("a\x1b[1m").error(), HasSubstr("control characters"));
    EXPECT_THAT(shell_words(std::string(kMaxShellLine + 1, 'a')).error(), HasSubstr("8192 bytes"));
    EXPECT_TRUE(shell_words(std::string(kMaxShellLine, 'a')));
    EXPECT_TRUE(shell_words("\xff\xfe"));
    EXPECT_EQ(shell_words("servo '{\"write\": {}}'\r").value(), (Line{"servo", "{\"write\": {}}"}));
}

TEST_F(ShellWordsTest, Completion_OffersWhatTheBoardHas) {
    EXPECT_THAT(completed("dis"), ElementsAre("distance"));
    EXPECT_THAT(completed("s"), Contains("servo"));
    EXPECT_THAT(completed("s"), Contains("subscribe"));
    EXPECT_THAT(completed("ex"), ElementsAre("exit"));
    EXPECT_THAT(completed("distance "), ElementsAre("measure", "report"));
    EXPECT_THAT(completed("distance m"), ElementsAre("measure"));
    EXPECT_THAT(completed("get dist"), ElementsAre("distance", "distance/"));
    EXPECT_THAT(completed("get distance/"), ElementsAre("distance/distance"));
    EXPECT_THAT(completed("subscribe "), ElementsAre("distance", "servo"));
    EXPECT_THAT(completed("subscribe distance se"), ElementsAre("servo"));
    EXPECT_THAT(completed("values se"), ElementsAre("servo"));
    EXPECT_THAT(completed("pin 13 h"), ElementsAre("high"));
    EXPECT_THAT(completed("wait --for onl"), ElementsAre("online"));
    EXPECT_THAT(completed("distance nosuch"), IsEmpty());
    EXPECT_THAT(completed("nosuch "), IsEmpty());
}

TEST(ShellValuesTest, TheNewestOfEachService_InTheOrderOfTheServices) {
    ShellValues values;
    EXPECT_EQ(values.line(80), "");
    values.services({"io", "distance"});
    EXPECT_TRUE(values.report("distance", "distance", "distance 42 cm"));
    EXPECT_FALSE(values.report("distance", "distance", "distance 42 cm"));
    EXPECT_TRUE(values.report("io", "analog", "analog 0=1"));
    EXPECT_EQ(values.line(80), "io analog 0=1   distance 42 cm");
    EXPECT_TRUE(values.report("distance", "distance", "distance 43 cm"));
    EXPECT_FALSE(values.report("other", "x", "x 1"));
    EXPECT_EQ(values.line(80), "io analog 0=1   distance 43 cm");
    EXPECT_EQ(values.line(12), "io analog 0…");
    values.services({"io"});
    EXPECT_EQ(values.line(80), "io analog 0=1");
}

TEST(ShellValuesTest, SelectedAndSwitchedOff) {
    ShellValues values;
    values.services({"io", "distance"});
    values.report("io", "a", "a 1");
    values.report("distance", "distance", "distance 42 cm");
    values.select({"distance"});
    EXPECT_EQ(values.line(80), "distance 42 cm");
    EXPECT_FALSE(values.report("io", "a", "a 2"));
    values.show(false);
    EXPECT_EQ(values.line(80), "");
    values.show(true);
    values.select({});
    EXPECT_EQ(values.line(80), "io a 2   distance 42 cm");
}

TEST(ShellValuesTest, WhatWasPublished_NeitherMovesTheCursorNorGrowsWithoutBound) {
    ShellValues values;
    values.services({"x"});
    values.report("x", "w", "\x1b[2J\n" + std::string(1000, 'y'));
    EXPECT_THAT(values.line(200), HasSubstr("x ?[2J?yyy"));
    EXPECT_LE(values.line(200).size(), 40U);
    for (int i = 0; i < 1000; ++i)
        values.report("x", "kind" + std::to_string(i), "v");
    EXPECT_LE(values.line(100'000).size(), 100U);
}

class LineHistoryTest : public ::testing::Test {
  protected:
    test::TempDir folder_;
    LineHistory history_{folder_.path() / "state" / "asipctl" / "history"};
};

TEST_F(LineHistoryTest, KeepsLines_ForTheUserAlone) {
    EXPECT_THAT(history_.lines(), IsEmpty());
    EXPECT_TRUE(history_.add("distance measure"));
    EXPECT_TRUE(history_.add(" secret"));
    EXPECT_TRUE(history_.add(""));
    EXPECT_TRUE(LineHistory(history_.file()).add("servo write 0 90"));
    EXPECT_THAT(history_.lines(), ElementsAre("distance measure", "servo write 0 90"));
    struct stat info{};
    ASSERT_EQ(stat(history_.file().c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777U, 0600U);
}

TEST_F(LineHistoryTest, IsBounded_TheNewestStay) {
    for (std::size_t i = 0; i < 2 * LineHistory::kMaxLines + 10; ++i)
        ASSERT_TRUE(history_.add("line " + std::to_string(i)));
    const auto lines = history_.lines();
    ASSERT_THAT(lines, SizeIs(LineHistory::kMaxLines));
    EXPECT_EQ(lines.back(), "line 2009");
    EXPECT_LT(std::filesystem::file_size(history_.file()), 2 * LineHistory::kMaxLines * 12);
}

TEST_F(LineHistoryTest, AFileThatIsNone_HarmsNothing) {
    history_.add("good");
    std::ofstream(history_.file(), std::ios::app) << std::string(20'000, 'x') << "\n\x01\x02\n\nlast\n";
    EXPECT_THAT(history_.lines(), ElementsAre("good", "last"));
    const LineHistory folder(folder_.path());
    EXPECT_THAT(folder.lines(), IsEmpty());
    EXPECT_FALSE(folder.add("x"));
    EXPECT_FALSE(LineHistory("/proc/nosuch/history").add("x"));
    EXPECT_TRUE(LineHistory({}).add("x"));
}

TEST_F(LineHistoryTest, LiesWhereStateLies) {
    std::map<std::string, std::string> variables{{"HOME", "/home/ann"}};
    const auto file = [&variables] {
        return LineHistory::file_of_user([&variables](const std::string& name) -> std::optional<std::string> {
                   const auto found = variables.find(name);
                   return found == variables.end() ? std::nullopt : std::optional(found->second);
               })
            .string();
    };
    EXPECT_EQ(file(), "/home/ann/.local/state/asipctl/history");
    variables["XDG_STATE_HOME"] = "/state";
    EXPECT_EQ(file(), "/state/asipctl/history");
    variables["XDG_STATE_HOME"] = "relative";
    EXPECT_EQ(file(), "/home/ann/.local/state/asipctl/history");
    variables.clear();
    EXPECT_EQ(file(), "");
}

}  // namespace
}  // namespace asip::cli
