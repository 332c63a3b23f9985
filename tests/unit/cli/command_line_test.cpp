// SPDX-License-Identifier: Apache-2.0
#include "cli/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

std::optional<int> parsed(const Words& words) {
    CommandLine line(all_verbs());
    testing::internal::CaptureStderr();
    const auto status = line.parse(words);
    testing::internal::GetCapturedStderr();
    return status;
}

TEST(CommandLine, DurationsOfEachUnit_AreReadEverywhere) {
    const std::vector<std::pair<std::string, std::chrono::milliseconds>> durations{
        {"500ms", 500ms}, {"7d", std::chrono::hours(7 * 24)}, {"1.5", 1500ms}};
    for (const auto& [text, expected] : durations) {
        CommandLine line(all_verbs());
        ASSERT_EQ(line.parse({"--timeout", text, "models"}), std::nullopt) << text;
        std::istringstream in;
        std::ostringstream out, err;
        Context context{in, out, err};
        ASSERT_TRUE(line.apply(context));
        EXPECT_EQ(context.timeout, expected) << text;
        EXPECT_EQ(parsed({"subscribe", "uno1", "-W", text}), std::nullopt) << text;
        EXPECT_EQ(parsed({"ping", "uno1", "-i", text}), std::nullopt) << text;
    }
    EXPECT_EQ(parsed({"top", "-i", "10ms"}), program::kExitUsage) << "at least 50ms";
    EXPECT_EQ(parsed({"top", "-i", "soon"}), program::kExitUsage);
}

TEST(CommandLine, NegativeNumbers_AreArguments) {
    EXPECT_EQ(parsed({"send", "uno1/motors", "motor", "0", "-100", "-o", "json"}), std::nullopt);
}

TEST(CommandLine, ListOfAnOption_EndsAtItsValue) {
    EXPECT_EQ(parsed({"list", "--kind", "servo,io", "--state", "lost", "boards"}), std::nullopt);
    EXPECT_EQ(parsed({"list", "--state", "lots"}), program::kExitUsage);
}

TEST(CommandLine, Numbers_AreCheckedAgainstTheirBounds) {
    for (const auto* count : {"0", "257", "-1", "x", ""})
        EXPECT_EQ(parsed({"send", "--stdin", "--in-flight", count}), program::kExitUsage) << count;
    EXPECT_EQ(parsed({"send", "--stdin", "--in-flight", "256"}), std::nullopt);
}

TEST(CommandLine, WrongTemplate_IsBlamedOnItsOptionOnce) {
    CommandLine line(all_verbs());
    testing::internal::CaptureStderr();
    EXPECT_TRUE(line.parse({"list", "--format", "{borad}"}));
    const auto errors = testing::internal::GetCapturedStderr();
    EXPECT_THAT(errors, HasSubstr("--format: there is no {borad} (did you mean \"board\"?)"));
    EXPECT_EQ(errors.find("format:"), errors.rfind("format:")) << errors;
}

TEST(CommandLine, HelpOfAVerb_ShowsWhatItDeclares) {
    const CommandLine line(all_verbs());
    EXPECT_THAT(*line.help("list"), HasSubstr("--state online|offline|lost|sleeping|updating"));
    EXPECT_THAT(*line.help(""), HasSubstr("Commands:"));
    EXPECT_EQ(line.help("lst").error().status, program::kExitUsage);
}

TEST(CommandLine, ForSomeArguments_DeclaresNoOptionsOfOtherVerbs) {
    const auto options_of = [](const CommandLine& line, const char* verb) {
        return line.app().get_subcommand(verb)->get_options().size();
    };
    const CommandLine all(all_verbs());
    for (const auto& verb : all_verbs()) {
        const CommandLine line(all_verbs(), {"--from-bus", verb.name, "x"});
        EXPECT_EQ(options_of(line, verb.name.c_str()), options_of(all, verb.name.c_str()));
        EXPECT_EQ(line.help(verb.name).value(), all.help(verb.name).value());
        EXPECT_EQ(line.help("").value(), all.help("").value());
        const char* const other = verb.name == "send" ? "list" : "send";
        const bool knows_all = verb.name == "help" || verb.name == "shell";
        EXPECT_EQ(options_of(line, other) < options_of(all, other), !knows_all) << verb.name;
    }
}

}  // namespace
}  // namespace asip::cli
