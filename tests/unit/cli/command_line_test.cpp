// SPDX-License-Identifier: Apache-2.0
#include "cli/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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
        ASSERT_EQ(line.parse({"--timeout", text, "model"}), std::nullopt) << text;
        std::istringstream in;
        std::ostringstream out, err;
        Environment environment{in, out, err};
        ASSERT_TRUE(line.apply(environment));
        EXPECT_EQ(environment.timeout, expected) << text;
        EXPECT_EQ(parsed({"subscribe", "uno1", "-W", text}), std::nullopt) << text;
        EXPECT_EQ(parsed({"ping", "uno1", "-i", text}), std::nullopt) << text;
    }
    EXPECT_EQ(parsed({"ping", "uno1", "-i", "soon"}), program::kExitUsage);
}

TEST(CommandLine, NamesOfOtherPrograms_AreAnsweredWithOurs_AndOthersInOneLine) {
    const auto told = [](std::vector<std::string> words) {
        CommandLine line(all_verbs(), words);
        testing::internal::CaptureStderr();
        EXPECT_EQ(line.parse(words), program::kExitUsage);
        return testing::internal::GetCapturedStderr();
    };
    EXPECT_THAT(told({"watch", "uno1"}), HasSubstr("try asipctl subscribe\n"));
    EXPECT_THAT(told({"--from-bus", "ls"}), HasSubstr("try asipctl list\n"));
    EXPECT_THAT(told({"devices"}), HasSubstr("try asipctl list\n"));
    EXPECT_THAT(told({"rm", "uno1"}), HasSubstr("try asipctl forget\n"));
    EXPECT_THAT(told({"mv", "uno1"}), HasSubstr("try asipctl label BOARD name=NAME\n"));
    EXPECT_THAT(told({"rename", "uno1", "x"}), HasSubstr("try asipctl label BOARD name=NAME\n"));
    EXPECT_THAT(told({"history", "uno1"}), HasSubstr("try asipctl events BOARD --last 20\n"));
    EXPECT_THAT(told({"logs"}), HasSubstr("try asipctl events --logs\n"));
    EXPECT_THAT(told({"models"}), HasSubstr("try asipctl model\n"));
    EXPECT_THAT(told({"explain", "servo"}), HasSubstr("try asipctl model KIND\n"));
    EXPECT_THAT(told({"prune"}), HasSubstr("try asipctl forget --leftovers\n"));
    EXPECT_EQ(told({"zzzzzzzz"}), "asipctl: there is no command \"zzzzzzzz\"\nTry asipctl --help\n");
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
    EXPECT_EQ(parsed({"ping", "uno1", "-n", "-1"}), program::kExitUsage) << "not 18446744073709551615";
    EXPECT_EQ(parsed({"ping", "uno1", "-n", "2"}), std::nullopt);
}

TEST(CommandLine, OptionThatIsGivenTwice_IsRefusedInPlainWords) {
    CommandLine line(all_verbs());
    testing::internal::CaptureStderr();
    EXPECT_EQ(line.parse({"list", "--board", "uno1", "--board", "uno2"}), program::kExitUsage);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("--board is given more than once"));
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

TEST(CommandLine, EmptyNames_AreRefused) {
    for (const Words& words : {Words{"show", ""}, Words{"label", ""}, Words{"label", "", "room=lab"},
                               Words{"open", ""}, Words{"pin", "uno1", ""}})
        EXPECT_EQ(parsed(words), program::kExitUsage) << testing::PrintToString(words);
    EXPECT_EQ(parsed({"label", "--selector", "room=lab", "shelf=3"}), std::nullopt);
}

TEST(CommandLine, EmptyValueOfAnOption_IsRefusedWithWhatToGive) {
    const std::vector<std::pair<Words, std::string>> cases{
        {{"events", "--since", ""}, "--since: is empty; give WHEN"},
        {{"list", "--board", ""}, "--board: is empty; give PATTERN"},
        {{"list", "--kind", ""}, "--kind: is empty; give KIND"},
        {{"list", "--format", ""}, "--format: is empty; give TEMPLATE"},
        {{"subscribe", "uno1", "--field", ""}, "--field: is empty; give FIELD"},
        {{"send", "uno1", "--raw", ""}, "--raw: is empty; give LINE"}};
    for (const auto& [words, expected] : cases) {
        CommandLine line(all_verbs());
        testing::internal::CaptureStderr();
        EXPECT_EQ(line.parse(words), program::kExitUsage) << testing::PrintToString(words);
        EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr(expected));
    }
}

TEST(CommandLine, WordsBehindTheDashes_AreArgumentsWhereverTheDashesStand) {
    for (const Words& words : {Words{"send", "--no-wait", "uno1/servo", "write", "--", "0", "-1"},
                               Words{"send", "--no-wait", "uno1/servo", "write", "0", "--", "-1"},
                               Words{"send", "uno1/servo", "--no-wait", "--", "write", "0", "-x"},
                               Words{"send", "uno1/servo", "write", "--no-wait", "--", "0", "-x", "--"},
                               Words{"send", "--no-wait", "uno1/servo", "write", "0", "90", "--"},
                               Words{"send", "--no-wait", "--", "uno1/servo", "write", "--", "-o"},
                               Words{"list", "--", "services"}})
        EXPECT_EQ(parsed(words), std::nullopt) << testing::PrintToString(words);
    EXPECT_EQ(parsed({"list", "--", "services", "-o"}), program::kExitUsage);
    EXPECT_EQ(parsed({"list", "--", "-o"}), program::kExitUsage);
}

TEST(CommandLine, ForSomeArguments_DeclaresTheVerbThatIsGiven) {
    const auto options_of = [](const CommandLine& line, const char* verb) {
        return line.app().get_subcommand(verb)->get_options().size();
    };
    const CommandLine all(all_verbs());
    for (const auto& verb : all_verbs()) {
        const CommandLine line(all_verbs(), {"--from-bus", "--services", "send", verb.name, "list"});
        EXPECT_EQ(options_of(line, verb.name.c_str()), options_of(all, verb.name.c_str()));
        EXPECT_EQ(line.help(verb.name).value(), all.help(verb.name).value());
        const auto known = line.app().get_subcommands([](const CLI::App*) { return true; }).size();
        const bool knows_all = verb.name == "help";
        EXPECT_EQ(known, knows_all ? all_verbs().size() : 1U) << verb.name;
        if (knows_all) {
            EXPECT_EQ(line.help("").value(), all.help("").value());
        }
    }
}

TEST(CommandLine, Help_ShowsAboutTwelveVerbsAndWithAllEachOne) {
    const CommandLine line(all_verbs());
    const auto shown_in = [](const std::string& text) {
        const auto verbs = all_verbs();
        return std::count_if(verbs.begin(), verbs.end(), [&text](const Verb& verb) {
            return text.find("\n  " + verb.name + " ") != std::string::npos &&
                   text.find(verb.summary) != std::string::npos;
        });
    };
    EXPECT_EQ(shown_in(line.help("").value()), 13);
    EXPECT_EQ(shown_in(line.help("all").value()), static_cast<std::ptrdiff_t>(all_verbs().size()));
    EXPECT_THAT(line.help("").value(), testing::HasSubstr("asipctl help all"));
}

TEST(CommandLine, ForSomeArguments_ErrorsNameAllVerbs) {
    const auto said = [](CommandLine& line, const std::vector<std::string>& arguments) {
        testing::internal::CaptureStderr();
        testing::internal::CaptureStdout();
        const auto status = line.parse(arguments);
        return std::to_string(status.value_or(-1)) + testing::internal::GetCapturedStderr() +
               testing::internal::GetCapturedStdout();
    };
    const std::vector<std::vector<std::string>> lines{{},
                                                      {"lst"},
                                                      {"zzzzzzzz", "list"},
                                                      {"--sate", "lost", "list"},
                                                      {"--no-mdns", "zzzzzzzz", "list"},
                                                      {"list", "lst"},
                                                      {"list", "--sate", "lost"},
                                                      {"list", "boards", "show"},
                                                      {"--", "list"},
                                                      {"--broker"},
                                                      {"--services", "list"},
                                                      {"", "list"},
                                                      {"--help"},
                                                      {"--help", "list"},
                                                      {"list", "--help"},
                                                      {"--version", "list"}};
    for (const auto& arguments : lines) {
        CommandLine all(all_verbs());
        CommandLine some(all_verbs(), arguments);
        EXPECT_EQ(said(some, arguments), said(all, arguments)) << testing::PrintToString(arguments);
    }
}

}  // namespace
}  // namespace asip::cli
