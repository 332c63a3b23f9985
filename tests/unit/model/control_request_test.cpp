// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/model_set.hpp"

namespace asip::model {
namespace {

using testing::HasSubstr;

const ServiceModel& servo() {
    return *ModelSet::standard().find("servo");
}

nlohmann::json object(std::string_view text) {
    return nlohmann::json::parse(text);
}

TEST(EncodeControl, EachForm_GivesTheSameLine) {
    for (const std::string_view text : {"W,0,90", "W,0,90\n", "W,0,90\r\n"}) {
        const auto command = encode_control_text(&servo(), 'S', text);
        ASSERT_TRUE(command) << text << ": " << command.error();
        EXPECT_EQ(command->line, "S,W,0,90") << text;
    }
    for (const std::string_view text :
         {R"({"write":[0,90]})", R"({"write":{"servo":0,"angle":90}})", R"({"raw":"W,0,90"})"}) {
        const auto command = encode_control_json(&servo(), 'S', object(text));
        ASSERT_TRUE(command) << text << ": " << command.error();
        EXPECT_EQ(command->line, "S,W,0,90") << text;
    }
}

TEST(EncodeControl, ValueOutOfRange_IsRefusedByItsName) {
    const auto command = encode_control_json(&servo(), 'S', object(R"({"write":[0,900]})"));
    ASSERT_FALSE(command);
    EXPECT_EQ(command.error(), "angle: 900 is above 180");
}

TEST(EncodeControl, ServiceWithoutModel_TakesTextOnly) {
    EXPECT_EQ(encode_control_text(nullptr, 'X', "q,1")->line, "X,q,1");
    EXPECT_EQ(encode_control_json(nullptr, 'X', object(R"({"raw":"q,1"})"))->line, "X,q,1");
    EXPECT_THAT(encode_control_json(nullptr, 'X', object(R"({"go":[1]})")).error(),
                HasSubstr("no model describes service X"));
    EXPECT_FALSE(encode_control_text(nullptr, 'X', ""));
}

TEST(EncodeControl, HostileText_IsRefused) {
    for (const auto& text :
         {std::string("{"), std::string(1'000'000, 'x'), std::string(1'000'000, '['), std::string("W,0\n,90"),
          std::string("W,0,90\nW,1,90"), std::string("\0\1\2", 3)}) {
        EXPECT_FALSE(encode_control_text(&servo(), 'S', text)) << text.substr(0, 20);
    }
}

TEST(EncodeControl, ObjectThatIsNoCommand_IsRefused) {
    for (const std::string_view text : {"{}", "[1]", "7", "null", R"({"raw":7})", R"({"raw":["W,0,90"]})"})
        EXPECT_FALSE(encode_control_json(&servo(), 'S', object(text))) << text;
}

}  // namespace
}  // namespace asip::model
