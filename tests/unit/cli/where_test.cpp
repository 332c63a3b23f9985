// SPDX-License-Identifier: Apache-2.0
#include "cli/text/where.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::cli {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> kFields{"board", "state", "chip", "age", "services", "conflict"};

const nlohmann::json kRecord =
    nlohmann::json::parse(R"({"board":"uno1","state":"online","chip":"ATmega328P","age":75.5,)"
                          R"("services":[{"name":"io"},{"name":"distance","period":100}]})");

bool holds(const std::string& text) {
    const auto where = Where::parse(text, kFields);
    EXPECT_TRUE(where) << text << ": " << where.error();
    return where && where->holds(kRecord);
}

TEST(Where, EachSign_ComparesAsItsReaderExpects) {
    for (const auto* text : {"state=online", "state == 'online'", "chip~ATmega*", "chip!~ATtiny*", "age>75",
                             "age>=75.5", "age<2m", "age > 1m", "board<=uno1", "board>uno", "age"})
        EXPECT_TRUE(holds(text)) << text;
    for (const auto* text : {"state=lost", "state!=online", "chip~ATtiny*", "age>100", "age>2m", "conflict",
                             "conflict=x", "board<uno1"})
        EXPECT_FALSE(holds(text)) << text;
    EXPECT_TRUE(holds("conflict!=x")) << "what is not there is not equal";
}

TEST(Where, PathsIntoArrays_HoldForAnyElement) {
    EXPECT_TRUE(holds("services.name=distance"));
    EXPECT_TRUE(holds("services.period<200"));
    EXPECT_FALSE(holds("services.name!=distance")) << "one is";
    EXPECT_TRUE(holds("services.name!=servo"));
    EXPECT_TRUE(holds("services.0.name=io"));
    EXPECT_FALSE(holds("services.7.name=io"));
    EXPECT_FALSE(holds("services.name.x=io"));
}

TEST(Where, WordsBetween_BindAsUsual) {
    EXPECT_TRUE(holds("state=lost and age>1 or board=uno1"));
    EXPECT_FALSE(holds("state=lost and (age>1 or board=uno1)"));
    EXPECT_TRUE(holds("not state=lost and not (conflict or state=lost)"));
}

TEST(Where, FaultyText_IsRefusedWithWhatIsWrong) {
    const auto error = [](const std::string& text) {
        const auto where = Where::parse(text, kFields);
        return where ? "accepted" : where.error();
    };
    EXPECT_THAT(error("sate=online"), HasSubstr("did you mean \"state\""));
    EXPECT_THAT(error(""), HasSubstr("a member is expected at the end"));
    EXPECT_THAT(error("state="), HasSubstr("a value is expected"));
    EXPECT_THAT(error("state=online chip=x"), HasSubstr("join conditions with and, or"));
    EXPECT_THAT(error("(state=online"), HasSubstr("never closed"));
    EXPECT_THAT(error("state='online"), HasSubstr("a quote is never closed"));
    EXPECT_THAT(error("state=<x"), HasSubstr("is none of"));
    EXPECT_THAT(error("and"), HasSubstr("there is no \"and\""));
    EXPECT_THAT(error(std::string(400, '(')), HasSubstr("too many parentheses"));
    EXPECT_THAT(error(std::string(1001, 'x')), HasSubstr("1000"));
}

}  // namespace
}  // namespace asip::cli
