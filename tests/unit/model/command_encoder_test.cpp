// SPDX-License-Identifier: Apache-2.0
#include "asip/model/command_encoder.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const ServiceModel& standard(const char* name) {
    return *ModelSet::standard().find(name);
}

std::string from_json(const char* model, const char* command) {
    const auto result = encode_json_command(standard(model), json::parse(command));
    return result ? result->line : "! " + result.error();
}

std::string from_text(const char* model, std::string_view text) {
    const auto result = encode_text_command(standard(model), text);
    return result ? result->line : "! " + result.error();
}

std::string from_words(const char* model, std::vector<std::string> words) {
    const auto result = encode_word_command(standard(model), words);
    return result ? result->line : "! " + result.error();
}

TEST(EncodeJson, Command_SaysWhatItIs) {
    const auto result = encode_json_command(standard("distance"), json::parse(R"({"measure":null})"));
    ASSERT_TRUE(result);
    EXPECT_EQ(result->line, "D,M");
    EXPECT_EQ(result->command, "measure");
    EXPECT_EQ(result->service, 'D');
    EXPECT_EQ(result->tag, 'M');
    EXPECT_EQ(result->answer, 'e');
}

std::string safe_form(const char* model, const char* command) {
    const auto result = encode_json_command(standard(model), json::parse(command));
    return result ? result->safe : "! " + result.error();
}

TEST(SafeForm, EachActuator_IsUndoneForTheElementThatWasCommanded) {
    EXPECT_EQ(safe_form("motors", R"({"power":[1,-128]})"), "M,s,1");
    EXPECT_EQ(safe_form("motors", R"({"drive":{"power0":10,"power1":20}})"), "M,M,0,0");
    EXPECT_EQ(safe_form("tone", R"({"play":[440,500]})"), "T,P,0,0");
    EXPECT_EQ(safe_form("io", R"({"write":[13,"high"]})"), "I,d,13,0");
    EXPECT_EQ(safe_form("io", R"({"pwm":{"duty":200,"pin":3}})"), "I,a,3,0");
    EXPECT_EQ(safe_form("neopixels", R"({"brightness":[1,40]})"), "N,B,1,0");
}

TEST(SafeForm, AsTextOrAsWords_IsTheSame) {
    EXPECT_EQ(encode_text_command(standard("motors"), "m,1,-128")->safe, "M,s,1");
    EXPECT_EQ(encode_word_command(standard("io"), std::vector<std::string>{"write", "13", "high"})->safe,
              "I,d,13,0");
}

TEST(SafeForm, WhatIsSafeOrMovesByItself_HasNone) {
    EXPECT_EQ(safe_form("motors", R"({"stop":1})"), "");
    EXPECT_EQ(safe_form("servo", R"({"write":[0,90]})"), "") << "a servo that turns back may do harm";
    EXPECT_EQ(safe_form("distance", R"({"measure":null})"), "");
}

TEST(SafeForm, StandardActuators_CanBeStoppedAsAWhole) {
    EXPECT_EQ(standard("motors").safe, (std::vector<std::string>{"M,S"}));
    EXPECT_EQ(standard("tone").safe, (std::vector<std::string>{"T,P,0,0"}));
    EXPECT_TRUE(standard("pixels").safe.empty()) << "the strip would stay dark for whoever sets colors";
    EXPECT_TRUE(standard("io").safe.empty()) << "which pins are outputs, only the agent knows";
}

TEST(SafeForm, Usage_NamesTheArgumentsThatAreTakenOver) {
    const auto& motors = standard("motors");
    EXPECT_EQ(safe_usage(motors, *motors.command("power")), "M,s,motor");
    EXPECT_EQ(safe_usage(motors, *motors.command("drive")), "M,M,0,0");
    EXPECT_EQ(safe_usage(motors, *motors.command("stop")), "");
}

TEST(EncodeJson, IdAndReplyTo_ArePassedOver) {
    EXPECT_EQ(from_json("servo", R"({"id":"7","write":[0,90],"reply_to":"me"})"), "S,W,0,90");
}

TEST(EncodeJson, NotOneCommand_IsRefused) {
    EXPECT_EQ(from_json("servo", "[]"), "! a command is an object such as {\"NAME\":[ARGUMENTS]}");
    EXPECT_EQ(from_json("servo", R"({"id":"7"})"), "! it has no command");
    EXPECT_EQ(from_json("servo", R"({"remap":[1],"write":[0,1]})"),
              "! one command at a time: 'remap' or 'write'");
}

TEST(EncodeJson, UnknownCommand_NamesTheNearestOrAll) {
    EXPECT_EQ(from_json("servo", R"({"wirte":[0,1]})"), "! no command 'wirte'; did you mean 'write'?");
    EXPECT_EQ(from_json("servo", R"({"\u001b[2J":null})"), "! no command '\\x1b[2J'; servo has remap, write");
    EXPECT_EQ(from_json("servo", R"({"explode":null})"), "! no command 'explode'; servo has remap, write");
}

TEST(EncodeJson, WrongTypes_AreRefused) {
    for (const char* value :
         {"null", "\"90\"", "[]", "{}", "1.5", "1e300", "-1e300", "99999999999999999999"}) {
        const auto command = std::string(R"({"write":[0,)") + value + "]}";
        EXPECT_THAT(from_json("servo", command.c_str()), HasSubstr("! angle: ")) << value;
    }
    EXPECT_EQ(from_json("servo", R"({"write":"x"})"), "! write: argument 'angle' is missing");
    EXPECT_EQ(from_json("servo", R"({"remap":{"pins":7}})"), "! pins: 7 is not a list");
    EXPECT_EQ(from_json("pixels", R"({"set":[{"pixel":0,"colour":1}]})"), "! pixels/0: 'color' is missing");
}

TEST(EncodeJson, WholeNumberWrittenAsFraction_IsAnInteger) {
    EXPECT_EQ(from_json("servo", R"({"write":[0,90.0]})"), "S,W,0,90");
}

TEST(EncodeJson, RequestLongerThanABoardTakes_IsRefused) {
    const std::vector<std::string> white(27, "#ffffff");
    EXPECT_EQ(from_json("pixels", json{{"fill", {0, white}}}.dump().c_str()),
              "! fill: the request would be 253 bytes long, above 250; send it in parts");
}

TEST(EncodeJson, ListLongerThanAllowed_IsRefused) {
    EXPECT_EQ(from_json("lcd", R"({"bars":[[0,1],[1,1],[2,1],[3,1],[4,1],[0,1]]})"),
              "! bars: 6 items are more than 5");
    json pins = json::array();
    for (int i = 0; i < 10000; ++i)
        pins.push_back(0);
    EXPECT_FALSE(encode_json_command(standard("servo"), json{{"remap", pins}}));
}

TEST(EncodeText, Request_IsCheckedByTheModel) {
    EXPECT_EQ(from_text("servo", "W,0,90"), "S,W,0,90");
    EXPECT_EQ(from_text("distance", "M"), "D,M");
    EXPECT_EQ(from_text("lcd", "W,0,a, b,c"), "L,W,0,a, b,c");
    EXPECT_EQ(from_text("servo", "W,0,181"), "! angle: 181 is above 180");
    EXPECT_EQ(from_text("servo", "W,0"), "! write: argument 'angle' is missing");
    EXPECT_EQ(from_text("servo", "W,0,1,2"), "! write takes 2 arguments (servo, angle), not 3");
    EXPECT_EQ(from_text("servo", "W,0,"), "! angle: \"\" is not an integer");
    EXPECT_EQ(from_text("distance", "M,1"), "! measure takes no argument, not 1");
    EXPECT_EQ(from_text("servo", "Z"), "! servo has no command with tag 'Z'");
}

TEST(EncodeText, List_MustAgreeWithItsCount) {
    EXPECT_EQ(from_text("servo", "M,2,9,10"), "S,M,2,9,10");
    EXPECT_EQ(from_text("servo", "M,3,9,10"), "! count is 3, but pins holds 2");
    EXPECT_EQ(from_text("pixels", "P,1,{0:255}"), "P,P,1,{0:255}");
    EXPECT_EQ(from_text("pixels", "P,1,0:255"), "! pixels: needs braces { }");
    EXPECT_EQ(from_text("pixels", "P,1,{0}"), "! pixels/0: not an item of pixel:color");
    EXPECT_EQ(from_text("pixels", "P,0,{}"), "! pixels: the list is empty");
}

TEST(EncodeText, WhatIsNoRequest_IsRefused) {
    for (const std::string_view text : {"", "W0", ",", "W\n", "\x01"})
        EXPECT_FALSE(encode_text_command(standard("servo"), text)) << text;
    EXPECT_FALSE(encode_text_command(standard("servo"), std::string(1'000'000, 'W')));
}

TEST(RequestValues, AnySpelling_IsNumbersAndTexts) {
    const auto values = [](const char* model, std::string_view text) {
        const auto result = request_values(standard(model), text);
        return result ? result->values.dump() : "! " + result.error();
    };
    EXPECT_EQ(values("servo", "W,0,090"), "[0,90]");
    EXPECT_EQ(values("servo", "W,0,900"), "! angle: 900 is above 180");
    EXPECT_EQ(values("io", "P,13,output"), "[13,3]");
    EXPECT_EQ(values("lcd", "W,0,7,up"), R"([0,"7,up"])");
    EXPECT_EQ(values("pixels", "P,2,{0:255,1:#ff0000}"), "[[[0,255],[1,16711680]]]");
}

TEST(EncodeWords, AsTyped_IsUnderstood) {
    EXPECT_EQ(from_words("servo", {"write", "0", "90"}), "S,W,0,90");
    EXPECT_EQ(from_words("servo", {"W", "0", "90"}), "S,W,0,90");
    EXPECT_EQ(from_words("io", {"mode", "13", "output"}), "I,P,13,3");
    EXPECT_EQ(from_words("lcd", {"write", "0", "hello", "world"}), "L,W,0,hello world");
    EXPECT_EQ(from_words("pixels", {"set", "0:255", "1:#ff0000"}), "P,P,2,{0:255,1:16711680}");
    EXPECT_EQ(from_words("servo", {"remap", "9", "10"}), "S,M,2,9,10");
    EXPECT_EQ(from_words("distance", {"measure"}), "D,M");
    EXPECT_EQ(from_words("motors", {"drive", "-5", "5"}), "M,M,-5,5");
}

TEST(EncodeWords, ArgumentsByName_InAnyOrder) {
    EXPECT_EQ(from_words("servo", {"write", "angle=90", "servo=0"}), "S,W,0,90");
    EXPECT_EQ(from_words("io", {"mode", "mode=output", "pin=13"}), "I,P,13,3");
    EXPECT_EQ(from_words("lcd", {"write", "0", "a=b"}), "L,W,0,a=b") << "a text, no name";
    EXPECT_EQ(from_words("servo", {"write", "angle=90"}), "! write: argument 'servo' is missing");
    EXPECT_EQ(from_words("servo", {"write", "angle=90", "servo=0x"}), "! servo: \"0x\" is not an integer");
}

TEST(EncodeWords, Faults_AreNamed) {
    EXPECT_EQ(from_words("servo", {}), "! it has no command");
    EXPECT_EQ(from_words("servo", {"wirte"}), "! no command 'wirte'; did you mean 'write'?");
    EXPECT_EQ(from_words("servo", {"write", "0"}), "! write: argument 'angle' is missing");
    EXPECT_EQ(from_words("servo", {"write", "0", "90", "1"}),
              "! write takes 2 arguments (servo, angle), not 3");
    EXPECT_EQ(from_words("distance", {"measure", "now"}), "! measure takes no argument, not 1");
    EXPECT_EQ(from_words("servo", {"write", "0", "9x"}), "! angle: \"9x\" is not an integer");
}

TEST(Usage, Arguments_HaveRangeAndUnit) {
    EXPECT_EQ(usage(*standard("servo").command("write")), "servo 0..255, angle 0..180 degrees");
    EXPECT_EQ(usage(*standard("pixels").command("set")),
              "pixels (pixel 0..65535:color (number or #rrggbb))...");
    EXPECT_EQ(usage(*standard("io").command("write")), "pin 0..255, level 0..1 (high|low|off|on)");
    EXPECT_EQ(usage(*standard("lcd").command("clear")), "");
}

}  // namespace
}  // namespace asip::model
