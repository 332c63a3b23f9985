// SPDX-License-Identifier: Apache-2.0
#include "sim/board_file.hpp"

#include <gmock/gmock.h>

#include "monitor.hpp"

namespace asip::sim {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string refusal(std::string_view text) {
    const auto file = parse_board_file(text, "boards/x.json");
    return file ? "" : file.error();
}

std::string with_parts(const std::string& parts) {
    return R"({"image":"a.elf","parts":[)" + parts + "]}";
}

TEST(BoardFile, Whole_IsRead) {
    const auto file = parse_board_file(R"({
        "name": "desk", "board": "mega", "image": "../a.elf", "eeprom": "desk.eeprom", "link": "/tmp/desk", "tcp": 6789,
        "reset_on_open": true, "uart": 1,
        "parts": [
            {"kind": "led", "name": "lamp", "pin": 13, "active_low": true},
            {"kind": "button", "pin": 2},
            {"kind": "wire", "from": 5, "to": "A9"},
            {"kind": "potentiometer", "name": "pot", "pin": "A0", "position": 0.25},
            {"kind": "ultrasonic", "name": "sonar", "pin": 7, "distance": 42},
            {"kind": "ultrasonic", "name": "sonar2", "trigger": 8, "echo": 9},
            {"kind": "servo", "name": "arm", "pin": 10},
            {"kind": "square-wave", "name": "wave", "pin": 11, "hertz": 12.5}
        ]})",
                                       "boards/x.json");
    ASSERT_TRUE(file) << file.error();
    EXPECT_EQ(file->board.name, "desk");
    EXPECT_EQ(file->board.board, "mega");
    EXPECT_EQ(file->board.image, "boards/../a.elf");
    EXPECT_EQ(file->board.eeprom, "boards/desk.eeprom");
    EXPECT_EQ(file->link, "/tmp/desk");
    EXPECT_EQ(file->tcp_port, 6789);
    EXPECT_TRUE(file->reset_on_open);
    EXPECT_EQ(file->board.uart, '1');
    const auto& parts = file->board.parts;
    ASSERT_EQ(parts.size(), 8u);
    EXPECT_EQ(parts[0].name, "lamp");
    EXPECT_EQ(parts[0].kind, "led");
    EXPECT_EQ(parts[0].settings.dump(), R"({"active_low":true,"pin":13})");
    EXPECT_EQ(parts[7].kind, "square-wave");
}

TEST(BoardFile, OnlyAnImage_IsAnUnoNamedAfterTheFile) {
    const auto file = parse_board_file(R"({"image":"a.elf"})", "boards/x.json");
    ASSERT_TRUE(file) << file.error();
    EXPECT_EQ(file->board.name, "x");
    EXPECT_EQ(file->board.board, "uno");
    EXPECT_EQ(file->tcp_port, -1);
    EXPECT_FALSE(file->reset_on_open);
}

TEST(BoardFile, NotJson_NamesLineAndColumn) {
    EXPECT_THAT(refusal("{\n  \"image\": \"a.elf\",\n  \"parts\": [}\n"),
                StartsWith("boards/x.json:3:13: not correct JSON"));
    EXPECT_THAT(refusal(""), StartsWith("boards/x.json:1:1: not correct JSON"));
    EXPECT_THAT(refusal("{"), StartsWith("boards/x.json:1:2: not correct JSON"));
    EXPECT_THAT(refusal("\xff"), StartsWith("boards/x.json:1:1: not correct JSON"));
}

TEST(BoardFile, WrongShape_NamesThePlace) {
    EXPECT_EQ(refusal("[]"), "boards/x.json: /: is not an object");
    EXPECT_EQ(refusal("{}"), "boards/x.json: /image: is missing");
    EXPECT_EQ(refusal(R"({"image":5})"), "boards/x.json: /image: is not a string");
    EXPECT_EQ(refusal(R"({"image":"a","parts":{}})"), "boards/x.json: /parts: is not an array");
    EXPECT_EQ(refusal(with_parts("5")), "boards/x.json: /parts/0: is not an object");
    EXPECT_EQ(refusal(R"({"image":"a","tcp":70000})"),
              "boards/x.json: /tcp: 70000 is not a number from 0 to 65535");
    EXPECT_EQ(refusal(R"({"image":"a","reset_on_open":1})"),
              "boards/x.json: /reset_on_open: is not true or false");
    EXPECT_EQ(refusal(R"({"image":"a","name":"a b"})"),
              "boards/x.json: /name: a board's name has no spaces and no \"/\" in it");
}

TEST(BoardFile, UnknownWord_NamesTheNearestOne) {
    EXPECT_THAT(refusal(with_parts(R"({"kind":"buton","pin":2})")),
                StartsWith("boards/x.json: /parts/0/kind: there is no part \"buton\" (did you mean "
                           "\"button\"?); one of led"));
    EXPECT_EQ(refusal(with_parts(R"({"kind":"led","pin":2,"active-low":true})")),
              "boards/x.json: /parts/0/active-low: is unknown (did you mean \"active_low\"?)");
    EXPECT_THAT(refusal(R"({"image":"a","board":"leonard"})"), HasSubstr("(did you mean \"leonardo\"?)"));
    EXPECT_EQ(refusal(R"({"imag":"a"})"), "boards/x.json: /image: is missing");
}

TEST(BoardFile, PinProblems_NameThePart) {
    EXPECT_EQ(refusal(with_parts(R"({"kind":"led","pin":20})")),
              "boards/x.json: /parts/0/pin: there is no pin 20 on the uno (0 to 19, A0 to A5)");
    EXPECT_EQ(refusal(with_parts(R"({"kind":"led"})")), "boards/x.json: /parts/0/pin: is missing");
    EXPECT_EQ(refusal(with_parts(R"({"kind":"led","pin":true})")),
              "boards/x.json: /parts/0/pin: there is no pin true on the uno (0 to 19, A0 to A5)");
    EXPECT_EQ(
        refusal(with_parts(R"({"kind":"led","pin":2,"name":"a"},{"kind":"button","pin":2,"name":"b"})")),
        "boards/x.json: /parts/1: b: pin 2 is taken by a");
}

TEST(BoardFile, Examples_AreAllCorrect) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(EXAMPLES_FOLDER)) {
        const auto file = load_board_file(entry.path());
        EXPECT_TRUE(file) << file.error();
        ++count;
    }
    EXPECT_GE(count, 5);
}

TEST(BoardFile, FileThatIsNotThere_Refused) {
    EXPECT_THAT(load_board_file("/nowhere/x.json").error(),
                StartsWith("/nowhere/x.json: cannot read the board file"));
    EXPECT_THAT(load_board_file("/tmp").error(), HasSubstr("is a folder"));
}

}  // namespace
}  // namespace asip::sim
