// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/names.hpp"

#include <gtest/gtest.h>

namespace asip::generate {
namespace {

TEST(GeneratedNames, EachLanguage_HasItsForm) {
    EXPECT_EQ(pascal_case("stop-all"), "StopAll");
    EXPECT_EQ(pascal_case("a.b_c-2d"), "ABC2d");
    EXPECT_EQ(camel_case("stop-all"), "stopAll");
    EXPECT_EQ(snake_case("stop--all-"), "stop_all");
}

TEST(GeneratedNames, WordsOfTheLanguage_GetAnUnderscore) {
    EXPECT_EQ(camel_case("class"), "class_");
    EXPECT_EQ(camel_case("and"), "and_");
    EXPECT_EQ(cpp_name("linux"), "linux_");
    EXPECT_EQ(cpp_name("lambda"), "lambda");
}

TEST(GeneratedNames, TwoThatBecameOne_AreReportedWithBothOrigins) {
    Scope scope("Python");
    scope.add("a_b", "command a-b");
    scope.add("c", "command c");
    EXPECT_EQ(scope.fault(), "");
    scope.add("a_b", "command a_b");
    EXPECT_EQ(scope.fault(), "command a-b and command a_b both become a_b in Python: rename one");
}

TEST(GeneratedNames, TextInAComment_NeitherEndsItNorGoesOnInTheNextLine) {
    EXPECT_EQ(comment("ends in \\"), "ends in");
    EXPECT_EQ(comment("ends in \\ \\"), "ends in");
    EXPECT_EQ(comment("ends in ?\?/"), "ends in ?/");
    EXPECT_EQ(comment("*/ is nothing here"), "*/ is nothing here");
    EXPECT_EQ(comment("a\nb\xe2\x80\xae"
                      "c\xe2\x81\xa6"
                      "d\xef\xbb\xbf"
                      "\xc3\xa9"),
              "a?b?c?d?\xc3\xa9");
}

TEST(GeneratedNames, Literals_AreEscaped) {
    EXPECT_EQ(cpp_character('\''), "'\\''");
    EXPECT_EQ(cpp_character('\\'), "'\\\\'");
    EXPECT_EQ(cpp_character('W'), "'W'");
    EXPECT_EQ(string_literal("a\"b\\\n\xc3\xa9?"), "\"a\\\"b\\\\\\012\\303\\251\\?\"");
}

}  // namespace
}  // namespace asip::generate
