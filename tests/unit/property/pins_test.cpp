// SPDX-License-Identifier: Apache-2.0
// What a pin is: by its meaning, else by the last mode that a command set.
#include "asip/property/contact.hpp"
#include "asip/property/value.hpp"
#include "tests/unit/property/boards.hpp"

namespace asip::property::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

model::Meaning of_class(const std::string& klass) {
    model::Meaning meaning;
    meaning.klass = klass;
    return meaning;
}

TEST(PinProperty, ModeOfTheSketch_DecidesNothing) {
    auto board = board_with({"io"});
    board.pins.modes = "01234532323232323232";
    EXPECT_THAT(properties(board), IsEmpty());
}

TEST(PinProperty, CommandedMode_DecidesWithoutAMeaning) {
    auto board = board_with({"io"});
    board.labels.modes = {{2, 1}, {3, 5}, {4, 0}, {13, 3}, {14, 4}, {7, 4}};
    const auto all = properties(board);
    EXPECT_THAT(ids(all), ElementsAre("io/2", "io/3", "io/13", "io/14")) << "7 has no analog channel";
    EXPECT_EQ(property(all, "io/2").kind, Kind::kBinarySensor);
    EXPECT_EQ(property(all, "io/3").kind, Kind::kNumber);
    EXPECT_EQ(property(all, "io/13").kind, Kind::kSwitch);
    EXPECT_EQ(property(all, "io/14").name, "Pin A0");
}

TEST(PinProperty, InputWithPullUp_IsOnWhenLow) {
    auto board = board_with({"io"});
    board.labels.modes = {{2, 2}, {3, 1}};
    auto all = properties(board);
    EXPECT_EQ(value_in(property(all, "io/2"), json{{"digital", {{"2", 0}}}}), true);
    EXPECT_EQ(value_in(property(all, "io/3"), json{{"digital", {{"3", 0}}}}), false);
    board.labels.meanings["io/2"].inverted = false;
    board.labels.meanings["io/3"].inverted = true;
    all = properties(board);
    EXPECT_EQ(value_in(property(all, "io/2"), json{{"digital", {{"2", 0}}}}), false);
    EXPECT_EQ(value_in(property(all, "io/3"), json{{"digital", {{"3", 0}}}}), true);
}

TEST(PinProperty, ClassOfAnOutput_IsSetAlsoBeforeAnyMode) {
    auto board = board_with({"io"});
    board.labels.meanings["io/13"] = of_class("relay");
    board.labels.meanings["io/13"].inverted = true;
    auto all = properties(board);
    EXPECT_THAT(requests_for(property(all, "io/13"), true),
                ElementsAre(Request{"io", R"({"mode":[13,3]})"}, Request{"io", R"({"write":[13,0]})"}));
    board.labels.modes[13] = 3;
    board.pins.modes[13] = '3';
    all = properties(board);
    EXPECT_THAT(requests_for(property(all, "io/13"), true),
                ElementsAre(Request{"io", R"({"write":[13,0]})"}));
}

TEST(PinProperty, ClassOfANumber_IsReadAlsoBeforeAnyMode) {
    auto board = board_with({"io"});
    board.labels.meanings["io/14"] = of_class("energy");
    board.labels.meanings["io/7"] = of_class("level");
    auto all = properties(board);
    EXPECT_THAT(ids(all), ElementsAre("io/14")) << "7 has no analog channel";
    EXPECT_EQ(property(all, "io/14").kind, Kind::kSensor);
    EXPECT_FALSE(property(all, "io/14").advanced);
    board.labels.modes[7] = 5;
    EXPECT_THAT(ids(properties(board)), ElementsAre("io/7", "io/14")) << "a level is set, too";
}

TEST(PinProperty, ClassOfAnInputWithoutAMode_Floats) {
    auto board = board_with({"io"});
    for (const auto* id : {"io/2", "io/3", "io/4", "io/5", "io/6", "io/14"})
        board.labels.meanings[id] = of_class("motion");
    board.labels.modes = {{3, 2}, {4, 3}, {14, 4}};
    board.pins.modes[5] = '1';
    board.pins.modes[6] = '3';
    const auto all = properties(board);
    for (const auto* id : {"io/2", "io/4", "io/6"}) {
        EXPECT_TRUE(property(all, id).floating) << id;
        EXPECT_FALSE(is_reported(property(all, id))) << id;
    }
    for (const auto* id : {"io/3", "io/5", "io/14"})
        EXPECT_FALSE(property(all, id).floating) << id;
}

TEST(PinProperty, AnalogValue_GoesAlongItsLine) {
    auto board = board_with({"io"});
    board.labels.modes = {{14, 4}};
    board.labels.meanings["io/14"].line = {{0, 1023, 0, 100}};
    board.labels.meanings["io/14"].unit = "%";
    const auto all = properties(board);
    EXPECT_EQ(value_in(property(all, "io/14"), json{{"analog", {{"0", 1023}}}}), 100);
    EXPECT_EQ(property(all, "io/14").unit, "%");
}

TEST(PinProperty, PinOfAnotherService_IsNone) {
    auto board = board_with({"io", "servo"});
    board.pins.owners[9] = 'S';
    board.labels.modes = {{9, 3}};
    EXPECT_THAT(ids(properties(board)), testing::Not(testing::Contains("io/9")));
}

TEST(PinProperty, CommandThatContradictsTheMeaning_RefusesTheWriteAndSaysWhy) {
    auto board = board_with({"io"});
    board.labels.meanings["io/13"] = of_class("light");
    board.labels.meanings["io/12"] = of_class("light");
    board.labels.meanings["io/11"] = of_class("fan");
    board.labels.meanings["io/2"] = of_class("door");
    board.labels.modes = {{13, 2}, {12, 3}, {11, 4}, {2, 3}, {3, 3}};
    const auto all = properties(board);
    EXPECT_EQ(property(all, "io/13").refused,
              "a command made pin 13 input-pullup, and light needs an output: asipctl pin desk 13 output");
    EXPECT_NE(property(all, "io/11").refused, "");
    for (const auto* id : {"io/12", "io/2", "io/3"})
        EXPECT_EQ(property(all, id).refused, "") << id;
    board.labels.modes[13] = 3;
    EXPECT_EQ(property(properties(board), "io/13").refused, "") << "once a command made it one";
}

}  // namespace
}  // namespace asip::property::test
