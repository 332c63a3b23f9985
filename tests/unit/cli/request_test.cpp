// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "cli/ask/board_request.hpp"
#include "cli/commands/pin.hpp"
#include "tests/unit/cli/boards.hpp"

namespace asip::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RequestTest : public ::testing::Test {
  protected:
    Outcome<BoardCommand> make(const std::string& service, const std::vector<std::string>& words) {
        return make_command(environment_, board_, *find_service(board_, service), words);
    }

    std::istringstream in_;
    std::ostringstream out_, err_;
    Environment environment_{in_, out_, err_};
    KnownBoard board_{announced(), *model::parse_description(kUno1)};
};

TEST_F(RequestTest, WordsAndJson_BecomeTheSameRequest) {
    const auto words = make("servo", {"write", "0", "90"});
    ASSERT_TRUE(words) << words.error().text;
    EXPECT_EQ(words->topic, "asip/uno1/servo/in");
    EXPECT_EQ(words->payload, "W,0,90");
    EXPECT_EQ(words->line, "S,W,0,90");
    EXPECT_EQ(make("servo", {R"({"write":{"servo":0,"angle":90}})"})->payload, "W,0,90");
}

TEST_F(RequestTest, WhatTheModelForbids_NeverLeaves) {
    for (const auto& words : std::vector<std::vector<std::string>>{{},
                                                                   {"write"},
                                                                   {"write", "0"},
                                                                   {"write", "0", "181"},
                                                                   {"write", "0", "x"},
                                                                   {"wirte", "0", "9"},
                                                                   {"{"}}) {
        const auto command = make("servo", words);
        ASSERT_FALSE(command);
        EXPECT_EQ(command.error().status, program::kExitUsage);
    }
    EXPECT_THAT(make("servo", {"wirte", "0", "9"}).error().text, HasSubstr("did you mean 'write'"));
    EXPECT_THAT(make("servo", {"write", "0"}).error().text, HasSubstr("angle 0..180"));
}

TEST_F(RequestTest, UnknownCommand_NamesThoseThereAreOnce) {
    const auto text = make("servo", {"fly", "0"}).error().text;
    EXPECT_THAT(text, HasSubstr("no command 'fly'; servo has remap, write"));
    EXPECT_EQ(text.find("write"), text.rfind("write")) << text;
    EXPECT_THAT(make("servo", {}).error().text, HasSubstr("which command? There are remap, write"));
}

TEST_F(RequestTest, ServiceNobodyDescribed_TakesTagAndParameters) {
    EXPECT_EQ(make("X", {"A", "100"})->payload, "A,100");
    EXPECT_FALSE(make("X", {"A", "1\nS,W,0,0"}));
}

TEST_F(RequestTest, RawLine_MustBeARequest) {
    EXPECT_EQ(make_raw_command(environment_, "uno1", "S,W,0,90")->topic, "asip/uno1/in");
    EXPECT_FALSE(make_raw_command(environment_, "uno1", "hello"));
    EXPECT_FALSE(make_raw_command(environment_, "uno1", "S,W,0\nS,W,1"));
}

TEST(ExitStatus, OfEachAnswer_IsAsDocumented) {
    EXPECT_EQ(exit_status(bus::Reply::ok("fence")), 0);
    EXPECT_EQ(exit_status(bus::Reply::board_error(7, "INVALID_DEVICE_NUMBER")), 1);
    EXPECT_EQ(exit_status(bus::Reply::refused("queue-full", "")), 1);
    EXPECT_EQ(exit_status(bus::Reply::timeout()), 4);
    EXPECT_EQ(failure_of(bus::Reply::board_error(7, "INVALID_DEVICE_NUMBER"), "desk: ").text,
              "desk: the board refused it: INVALID_DEVICE_NUMBER (error 7)");
}

TEST(AnswerText, RawLine_IsNotQuoted) {
    EXPECT_EQ(answer_text(bus::Reply::ok("fence")), "ok");
    EXPECT_EQ(answer_text(bus::Reply::ok("answer", "\"@#,?,0,4\"")), "@#,?,0,4");
    EXPECT_EQ(answer_text(bus::Reply::ok("answer", R"({"modes":[6]})")), R"({"modes":[6]})");
}

TEST(WhyTaken, PinOfAnotherService_NamesIt) {
    const auto description = *model::parse_description(kUno1);
    EXPECT_THAT(why_taken(description, 9), HasSubstr("pin 9 belongs to the service uno1/servo"));
    EXPECT_THAT(why_taken(description, 0), HasSubstr("the board itself"));
    EXPECT_EQ(why_taken(description, 3), "");
    EXPECT_EQ(why_taken(description, 200), "");
    EXPECT_EQ(why_taken(model::Description{}, 9), "");
}

TEST(ParsePin, NumbersAndArduinoNames_AreUnderstood) {
    const auto pins = model::parse_description(kUno1)->pins;
    EXPECT_EQ(parse_pin("13", pins), 13);
    EXPECT_EQ(parse_pin("D13", pins), 13);
    EXPECT_EQ(parse_pin("A1", pins), 15);
    for (const auto* text : {"", "A", "A7", "x", "-1", "256", "13x"})
        EXPECT_FALSE(parse_pin(text, pins)) << text;
}

TEST(PinWords, NameOfAPin_IsTakenForItsNumberUnlessTwoHaveIt) {
    model::Description board;
    board.labels.pins = {{13, "status lamp"}, {2, "door"}, {3, "door"}, {4, "5"}};
    EXPECT_EQ(find_pin("status lamp", board), 13);
    EXPECT_EQ(find_pin("12", board), 12);
    EXPECT_EQ(find_pin("5", board), 5) << "a number is a number";
    const auto both = find_pin("door", board);
    ASSERT_FALSE(both);
    EXPECT_THAT(both.error().text, HasSubstr("pins 2 and 3 are both called door"));
    EXPECT_FALSE(find_pin("status", board));
}

TEST(PinWords, BringTheModeTheyNeed) {
    using protocol::PinMode;
    EXPECT_THAT(pin_requests(13, *parse_pin_word("high"), PinMode::kInput), ElementsAre("P,13,3", "d,13,1"));
    EXPECT_THAT(pin_requests(13, *parse_pin_word("low"), PinMode::kOutput), ElementsAre("d,13,0"));
    EXPECT_THAT(pin_requests(3, *parse_pin_word("128"), PinMode::kOutput), ElementsAre("P,3,5", "a,3,128"));
    EXPECT_THAT(pin_requests(2, *parse_pin_word("pullup"), PinMode::kInputPullup), ElementsAre("P,2,2"));
}

TEST(PinWords, Unknown_AreRefusedWithTheNearest) {
    EXPECT_FALSE(parse_pin_word("256"));
    EXPECT_FALSE(parse_pin_word("reserved"));
    const auto word = parse_pin_word("hihg");
    ASSERT_FALSE(word);
    EXPECT_THAT(word.error().text, HasSubstr("high"));
    EXPECT_EQ(word.error().status, program::kExitUsage);
}

}  // namespace
}  // namespace asip::cli
