// SPDX-License-Identifier: Apache-2.0
// Completion of the real verbs: what each declares is what is offered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "cli/complete.hpp"
#include "tests/support/words.hpp"

namespace asip::cli {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using Words = std::vector<std::string>;

class CompletionTest : public ::testing::Test {
  protected:
    /// Completes what follows the last blank of `line`.
    Words after(const std::string& line) {
        const auto typed = typed_shell_line("asipctl " + line);
        return complete(line_.app(), typed.words, typed.start, names_);
    }

    CommandLine line_{all_verbs()};
    int asked_ = 0;
    NameSources names_{
        [this] {
            ++asked_;
            return Words{"uno2", "uno1", "nano"};
        },
        [](const std::string& board) { return board == "uno1" ? Words{"servo", "io"} : Words{}; },
        [](const std::string& board, const std::string& service) {
            return board == "uno1" && service == "servo" ? Words{"write", "remap"} : Words{};
        },
        [](const std::string&, const std::string& service) {
            return service == "servo" ? Words{"angle"} : Words{};
        },
        [] { return Words{"servo", "distance"}; },
        [] { return Words{"cm", "ms"}; },
        [] { return Words{"room=lab", "floor=2"}; }};
};

TEST_F(CompletionTest, FirstWord_IsAVerb) {
    EXPECT_THAT(after("s"), ElementsAre("secure", "send", "show", "stop", "subscribe"));
    EXPECT_THAT(after(""), IsSupersetOf({"help", "list", "pin", "send", "show"}));
    EXPECT_THAT(after("x"), IsEmpty());
    EXPECT_THAT(after("help su"), ElementsAre("subscribe"));
    EXPECT_EQ(asked_, 0) << "the bus is asked only for names";
}

TEST_F(CompletionTest, EachDeclaredEnumeration_IsOfferedAndNoFiles) {
    EXPECT_THAT(after("list --state o"), ElementsAre("offline", "online"));
    EXPECT_THAT(after("list --state=o"), ElementsAre("--state=offline", "--state=online"));
    EXPECT_THAT(after("list --state lost,o"), ElementsAre("lost,offline", "lost,online"));
    EXPECT_THAT(after("list -o json"), ElementsAre("json", "jsonl"));
    EXPECT_THAT(after("list -o json "), ElementsAre("boards", "services"));
    EXPECT_THAT(after("forget --only r"), ElementsAre("registries"));
    EXPECT_THAT(after("completion "), ElementsAre("bash", "fish", "zsh"));
    EXPECT_THAT(after("secure re"), ElementsAre("renew", "revoke"));
    EXPECT_THAT(after("secure add b"), ElementsAre("board", "broker"));
    EXPECT_THAT(after("list --credentials "), ElementsAre(kOfferFiles));
    EXPECT_THAT(after("pin nano 13 h"), ElementsAre("high"));
    EXPECT_THAT(after("pin nano 13 ."), IsEmpty());
    EXPECT_THAT(after("list --unit c"), ElementsAre("cm"));
    EXPECT_THAT(after("list --kind "), ElementsAre("distance", "servo"));
    EXPECT_THAT(after("list -l "), ElementsAre("floor=2", "room=lab"));
    EXPECT_THAT(after("list -l floor=2,r"), ElementsAre("floor=2,room=lab"));
    EXPECT_THAT(after("label uno1 f"), ElementsAre("floor=2"));
}

TEST_F(CompletionTest, OptionsOfEveryCommand_AreOfferedWithTheirValues) {
    EXPECT_THAT(after("list --color a"), ElementsAre("always", "auto"));
    EXPECT_THAT(after("--log-level w"), ElementsAre("warning"));
    EXPECT_THAT(after("--mqtt-version "), ElementsAre("3.1.1", "5", "best"));
    EXPECT_THAT(after("list --s"), ElementsAre("--selector", "--services", "--sketch", "--sort", "--state"));
    EXPECT_THAT(after("--ca /etc/s"), ElementsAre(kOfferFiles));
    EXPECT_THAT(after("--services "), ElementsAre(kOfferFolders));
}

TEST_F(CompletionTest, AfterTheBrokersAddress_TheVerbFollows) {
    EXPECT_THAT(after("--broker 127.0.0.1:1884 lis"), ElementsAre("list"));
    EXPECT_THAT(after("--broker 127.0.0.1:1884 show n"), ElementsAre("nano", "nano/"));
    EXPECT_THAT(after("show --broker=127.0.0.1:1884 n"), ElementsAre("nano", "nano/"));
    EXPECT_THAT(after("--broker 127.0.0.1:18"), IsEmpty());
}

TEST_F(CompletionTest, BoardsServicesAndCommands_AreLive) {
    EXPECT_THAT(after("show u"), ElementsAre("uno1", "uno1/", "uno2", "uno2/"));
    EXPECT_THAT(after("subscribe nano u"), ElementsAre("uno1", "uno1/", "uno2", "uno2/"));
    EXPECT_THAT(after("send u"), ElementsAre("uno1/", "uno2/"));
    EXPECT_THAT(after("send uno1/"), ElementsAre("uno1/io", "uno1/servo"));
    EXPECT_THAT(after("send --no-wait uno1/servo w"), ElementsAre("write"));
    EXPECT_THAT(after("send uno1/servo write "), IsEmpty());
    EXPECT_THAT(after("pin n"), ElementsAre("nano"));
    EXPECT_THAT(after("ping "), ElementsAre("nano", "uno1", "uno2"));
}

TEST_F(CompletionTest, WrongLine_OffersNothing) {
    EXPECT_THAT(after("lst "), IsEmpty());
    EXPECT_THAT(after("list boards extra "), IsEmpty());
    EXPECT_THAT(after("list --sate=l"), IsEmpty());
}

TEST(TypedShellLine, BackslashesAndQuotes_AreUnderstood) {
    const auto typed = typed_shell_line(R"(asipctl label uno room=Dining\ r)");
    EXPECT_THAT(typed.words, ElementsAre("label", "uno"));
    EXPECT_EQ(typed.start, "room=Dining r");
    EXPECT_EQ(typed.quote, '\0');
    const auto single = typed_shell_line("asipctl list -l room='$(x) \\");
    EXPECT_EQ(single.start, "room=$(x) \\");
    EXPECT_EQ(single.quote, '\'');
    EXPECT_EQ(single.unquoted, 5U);
    const auto twice = typed_shell_line(R"(asipctl list -l "a\$b\c"'d)");
    EXPECT_EQ(twice.start, R"(a$b\cd)");
    EXPECT_EQ(twice.quote, '\'');
    EXPECT_EQ(twice.unquoted, 5U);
    EXPECT_THAT(typed_shell_line("asipctl list ").words, ElementsAre("list"));
    EXPECT_EQ(typed_shell_line("asipctl list ").start, "");
    EXPECT_THAT(typed_shell_line("asipctl").words, IsEmpty());
    EXPECT_THAT(typed_shell_line("").words, IsEmpty());
    EXPECT_EQ(typed_shell_line("asipctl x\\").start, "x");
}

Words in_bash(Words candidates, const std::string& line) {
    return for_bash(std::move(candidates), typed_shell_line("asipctl " + line));
}

TEST(ForBash, OnlyWhatBashReplaces_IsPrinted) {
    EXPECT_THAT(in_bash({"--state=lost"}, "list --state=l"), ElementsAre("lost"));
    EXPECT_THAT(in_bash({"uno1"}, "u"), ElementsAre("uno1"));
    EXPECT_THAT(in_bash({kOfferFiles}, "--ca=/etc"), ElementsAre(kOfferFiles));
    EXPECT_THAT(in_bash({"room=Dining room"}, "list -l room='Di"), ElementsAre("Dining room"));
    EXPECT_THAT(in_bash({"room=Dining room"}, "list -l 'room=Di"), ElementsAre("room=Dining room"));
}

TEST(ForBash, WhatBashWouldObey_HasABackslashOrIsLeftOut) {
    EXPECT_THAT(in_bash({"room=$(touch /tmp/x)"}, "list -l ro"), ElementsAre(R"(room=\$\(touch\ /tmp/x\))"));
    EXPECT_THAT(in_bash({"a`b", "a\"b", "a'b", "a\\b", "a!b", "a;b", "a&b", "a|b", "a>b", "a*b", "~a", "#a",
                         "a{b,c}"},
                        ""),
                ElementsAre("a\\`b", "a\\\"b", "a\\'b", "a\\\\b", "a\\!b", "a\\;b", "a\\&b", "a\\|b", "a\\>b",
                            "a\\*b", "\\~a", "\\#a", "a\\{b,c\\}"));
    EXPECT_THAT(in_bash({"a$b", "a'b", "a b"}, "list '"), ElementsAre("a$b", "a b"));
    EXPECT_THAT(in_bash({"a$b", "a`b", "a!b", "a\"b", "a\\b", "a'b"}, "list \""), ElementsAre("a'b"));
    EXPECT_THAT(in_bash({"K\u00fcche"}, ""), ElementsAre("K\u00fcche"));
}

TEST(WithoutUnshowable, ControlCharacters_AreOfferedToNoShell) {
    EXPECT_THAT(without_unshowable({"a\nb", "a\tb", "a\x1b[2J", "a\x7f", "a\u009b", "ok"}),
                ElementsAre("ok"));
}

/// A new verb cannot be forgotten: whatever it declares is either offered or known to be free.
TEST(Verbs, EachType_IsOneThatCompletionKnows) {
    const CommandLine line(all_verbs());
    const auto known = test::words(
        "BOARD PATTERN BOARD[/SERVICE] BOARD/SERVICE BOARD[/SERVICE[/FIELD]] COMMAND KIND UNIT VERB "
        "FILE DIR TEXT DURATION COUNT TEMPLATE LINE CHIP SKETCH PIN ADDRESS NAME TOPIC CONDITION HOST "
        "PORT PID HZ FACTOR DUTY BAUD FIELD WHEN JSON LEVEL VALUE BOARD/PROPERTY HH:MM-HH:MM "
        "FROM..TO=FROM..TO SELECTOR LABEL  ");
    const auto check = [&known](const CLI::App& app) {
        for (const auto* option : app.get_options()) {
            const auto type = option->get_positional() ? option->get_name(true) : option->get_type_name();
            if (type.find('|') == std::string::npos) {
                EXPECT_THAT(known, Contains(type)) << option->get_name();
            }
        }
    };
    check(line.app());
    for (const auto* verb : line.app().get_subcommands([](const CLI::App*) { return true; })) {
        check(*verb);
        EXPECT_THAT(verb->get_footer(), ::testing::HasSubstr("Example")) << verb->get_name();
    }
}

/// tests/docs runs what stands there.
TEST(Verbs, Each_IsShownByACommandOfThePagesThatAreRun) {
    std::string commands;
    for (const char* page :
         {"README.md", "docs/start-develop.md", "docs/asipctl.md", "docs/tls-and-access.md"}) {
        std::ifstream file(std::string(ASIP_TEST_SOURCE "/") + page);
        ASSERT_TRUE(file) << page;
        for (std::string line; std::getline(file, line);)
            if (line.starts_with("$ ")) commands += line + " \n";
    }
    for (const auto& verb : all_verbs()) {
        if (verb.name == "model") continue;  // docs/add-a-service.md, which tests/generated follows
        if (verb.name == "backup" || verb.name == "restore") continue;  // tests/programs/backup_test.py
        EXPECT_THAT(commands, ::testing::HasSubstr("asipctl " + verb.name + " "));
    }
}

TEST(Verbs, EachThatPrintsData_KnowsJsonLinesAndTemplates) {
    const CommandLine line(all_verbs());
    for (const auto* verb : line.app().get_subcommands([](const CLI::App*) { return true; })) {
        if (verb->get_name() == "help" || verb->get_name() == "completion" || verb->get_name() == "open" ||
            verb->get_name() == "model")
            continue;
        ASSERT_NE(verb->get_option_no_throw("--output"), nullptr) << verb->get_name();
        EXPECT_THAT(verb->get_option("--output")->get_type_name(), ::testing::HasSubstr("json|jsonl"));
        EXPECT_NE(verb->get_option_no_throw("--format"), nullptr) << verb->get_name();
    }
}

}  // namespace
}  // namespace asip::cli
