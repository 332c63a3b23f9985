// SPDX-License-Identifier: Apache-2.0
#include "cli/find/target.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cli/boards.hpp"

namespace asip::cli {
namespace target_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

KnownBoard uno1() {
    return {announced(), *model::parse_description(kUno1)};
}

TEST(ParseTarget, BoardOrBoardAndService_AreTakenApart) {
    EXPECT_EQ(parse_target("uno1")->board, "uno1");
    EXPECT_EQ(parse_target("uno1")->service, "");
    EXPECT_EQ(parse_target("uno1/servo")->service, "servo");
}

TEST(ParseTarget, InvalidNames_AreUsageErrorsThatSayWhy) {
    for (const auto* text :
         {"", "/servo", "uno1/", "uno 1", "uno1/a/b", "registry", "servicebus", "uno1/#", "+"}) {
        const auto target = parse_target(text);
        ASSERT_FALSE(target) << text;
        EXPECT_EQ(target.error().status, program::kExitUsage) << text;
        EXPECT_FALSE(target.error().text.empty());
    }
}

TEST(ParseTarget, Wildcards_OnlyWhereAllowed) {
    EXPECT_FALSE(parse_target("uno*"));
    const auto target = parse_target("uno?/dist*", true);
    ASSERT_TRUE(target);
    EXPECT_TRUE(target->is_pattern());
    EXPECT_TRUE(target->matches("uno1", "distance"));
    EXPECT_FALSE(target->matches("uno1", "servo"));
    EXPECT_FALSE(target->matches("uno12", "distance"));
    EXPECT_TRUE(parse_target("*", true)->matches("anything", "at-all"));
}

TEST(FindService, ByNameOrLetter_IsFound) {
    EXPECT_EQ(find_service(uno1(), "servo")->id, 'S');
    EXPECT_EQ(find_service(uno1(), "D")->name, "distance");
    EXPECT_EQ(find_service(uno1(), "X")->name, "X");
}

TEST(FindService, MistypedName_SuggestsAndListsWhatThereIs) {
    const auto service = find_service(uno1(), "serov");
    ASSERT_FALSE(service);
    EXPECT_EQ(service.error().status, program::kExitFailure);
    EXPECT_THAT(service.error().text, HasSubstr("did you mean \"servo\""));
    EXPECT_THAT(service.error().text, HasSubstr("io, distance, servo, X"));
}

TEST(SplitWords, BlanksAndQuotes_AreAsInAShell) {
    EXPECT_THAT(*split_words("  uno1/lcd write 0 'hello world'\r"),
                ElementsAre("uno1/lcd", "write", "0", "hello world"));
    EXPECT_THAT(*split_words("a \"b 'c'\" ''"), ElementsAre("a", "b 'c'", ""));
}

TEST(SplitWords, JsonObject_KeepsItsQuotes) {
    EXPECT_THAT(*split_words(R"(uno1/servo {"write":[0,90]})"),
                ElementsAre("uno1/servo", R"({"write":[0,90]})"));
}

TEST(SplitWords, OpenQuote_IsRefused) {
    EXPECT_FALSE(split_words("a 'b"));
}

}  // namespace target_test
}  // namespace asip::cli
