// SPDX-License-Identifier: Apache-2.0
#include "asip/program/command_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace asip::program {
namespace {

using Kind = CommandWord::Kind;
using Words = std::vector<std::string>;
using testing::ElementsAre;
using testing::HasSubstr;

class CommandWordsTest : public testing::Test {
  protected:
    CommandWordsTest() {
        app_.add_option("--broker", broker_, "");
        list_ = app_.add_subcommand("list", "");
        list_->fallthrough();
        list_->add_option("what", what_, "");
        list_->add_option("--state", state_, "");
        list_->add_flag("-w,--watch", watch_, "");
        app_.add_subcommand("show", "")->fallthrough();
    }

    std::vector<Kind> kinds(const Words& words) {
        std::vector<Kind> result;
        for (const auto& word : classify(app_, words))
            result.push_back(word.kind);
        return result;
    }

    CLI::App app_;
    CLI::App* list_ = nullptr;
    std::string broker_, what_, state_;
    bool watch_ = false;
};

TEST_F(CommandWordsTest, OptionsValuesAndArguments_AreDistinguished) {
    EXPECT_THAT(kinds({"--broker", "list", "list", "-w", "--state=lost", "boards", "--broker", "x"}),
                ElementsAre(Kind::kOption, Kind::kValue, Kind::kSubcommand, Kind::kOption, Kind::kOption,
                            Kind::kArgument, Kind::kOption, Kind::kValue));
}

TEST_F(CommandWordsTest, NegativeNumbersAndWordsAfterTwoDashes_AreArguments) {
    EXPECT_THAT(kinds({"list", "-100", "--", "-w"}),
                ElementsAre(Kind::kSubcommand, Kind::kArgument, Kind::kOption, Kind::kArgument));
}

TEST_F(CommandWordsTest, NextWord_IsWhatTheLineLacks) {
    EXPECT_EQ(next_word(app_, {}).kind, Kind::kSubcommand);
    EXPECT_EQ(next_word(app_, {"list", "--state"}).kind, Kind::kValue);
    EXPECT_EQ(next_word(app_, {"list"}).option->get_name(), "what");
    EXPECT_EQ(next_word(app_, {"list", "boards"}).option, nullptr) << "list takes one argument";
}

TEST_F(CommandWordsTest, UnknownSubcommand_IsNamedWithTheNearest) {
    EXPECT_EQ(unknown_word(app_, {"lst"}), "there is no command \"lst\" (did you mean \"list\"?)");
    EXPECT_EQ(unknown_word(app_, {"bogus"}), "there is no command \"bogus\"; there are list, show");
    EXPECT_EQ(unknown_word(app_, {"list", "bogus"}), std::nullopt);
}

TEST_F(CommandWordsTest, UnknownOption_IsNamedNotItsValue) {
    EXPECT_EQ(unknown_word(app_, {"list", "--sate", "lost"}),
              "there is no option \"--sate\" (did you mean \"--state\"?)");
    EXPECT_EQ(unknown_word(app_, {"list", "--sate=lost"}),
              "there is no option \"--sate\" (did you mean \"--state\"?)");
    EXPECT_EQ(unknown_word(app_, {"show", "--broke", "x"}),
              "there is no option \"--broke\" (did you mean \"--broker\"?)");
    EXPECT_EQ(unknown_word(app_, {"list", "-z"}), "there is no option \"-z\"");
    EXPECT_EQ(unknown_word(app_, {"list", "--state", "--sate"}), std::nullopt) << "a value is no option";
}

TEST_F(CommandWordsTest, WordTooMany_IsNamedWithWhatTheCommandTakes) {
    EXPECT_EQ(word_too_many(app_, {"list", "boards", "--state", "lost", "more"}),
              "list takes what; \"more\" is one too many");
    EXPECT_EQ(word_too_many(app_, {"show", "uno1"}), "show takes no arguments; \"uno1\" is one too many");
    EXPECT_EQ(word_too_many(app_, {"list", "boards"}), std::nullopt);
}

TEST(CommandWords, ProgramThatTakesArgumentsItself_HasNoUnknownSubcommand) {
    CLI::App app;
    std::vector<std::string> files;
    app.add_option("files", files, "");
    app.add_subcommand("ctl", "");
    EXPECT_EQ(unknown_word(app, {"a.json", "b.json"}), std::nullopt);
    EXPECT_EQ(classify(app, {"ctl"}).front().kind, Kind::kSubcommand);
}

TEST(OneOf, OtherWord_IsRefusedWithTheNearest) {
    CLI::App app;
    std::string when;
    const auto* option = one_of(app.add_option("--color", when, ""), {"auto", "always", "never"});
    EXPECT_EQ(option->get_type_name(), "auto|always|never");
    EXPECT_NO_THROW(app.parse("--color never"));
    try {
        app.parse("--color allways");
        FAIL();
    } catch (const CLI::ParseError& error) {
        EXPECT_THAT(error.what(), HasSubstr("--color"));
        EXPECT_THAT(error.what(), HasSubstr("did you mean \"always\"?"));
    }
}

}  // namespace
}  // namespace asip::program
