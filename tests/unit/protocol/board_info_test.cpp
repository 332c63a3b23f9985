// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/board_info.hpp"

#include <gmock/gmock.h>

#include "asip/protocol/extensions.hpp"

namespace asip::protocol {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

TEST(Banner, OfA04Board_IsRead) {
    const auto banner = parse_banner("!AsipHello running on ATmega328P with Services: I D S ");
    ASSERT_TRUE(banner);
    EXPECT_EQ(banner->sketch, "AsipHello");
    EXPECT_EQ(banner->chip, "ATmega328P");
    EXPECT_EQ(banner->services, "IDS");
}

TEST(Banner, WithoutServices_IsRead) {
    EXPECT_EQ(parse_banner("My sketch running on X with Services:")->services, "");
}

TEST(Banner, CutInHalfOrOtherText_IsNone) {
    for (const std::string_view text :
         {"", "!", "Hello running on ATmega328P with Serv", "running on X with Services: I",
          "Hello running on with Services: I", "llo with Services: I", "A running on B with Services: i d"}) {
        EXPECT_FALSE(parse_banner(text)) << text;
    }
}

TEST(BoardInfo, Answer_IsRead) {
    const auto info = parse_board_info("0,4,ATmega328P,20,AsipHello");
    ASSERT_TRUE(info);
    EXPECT_EQ(info->protocol(), "0.4");
    EXPECT_EQ(info->chip, "ATmega328P");
    EXPECT_EQ(info->pins, 20);
    EXPECT_EQ(info->sketch, "AsipHello");
}

TEST(BoardInfo, SketchWithCommasOrNone_IsRead) {
    EXPECT_EQ(parse_board_info("1,0,X,20,a,b")->sketch, "a,b");
    EXPECT_EQ(parse_board_info("1,0,X,20")->sketch, "");
}

TEST(ReadableName, IsUtf8WithoutControls) {
    EXPECT_EQ(readable_name("T\xc3\xbcr"), "T\xc3\xbcr");
    EXPECT_EQ(readable_name("\xf0\x9f\xa4\x96\xf0\x9f\x92\xa1"), "\xf0\x9f\xa4\x96\xf0\x9f\x92\xa1")
        << "only emoji";
    EXPECT_EQ(readable_name("T\xfcr"), "T?r") << "Latin-1";
    EXPECT_EQ(readable_name("a\xc3"), "a?") << "cut off";
    EXPECT_EQ(readable_name("\xc0\xaf\xed\xa0\x80\xf4\x90\x80\x80"), "?????????")
        << "overlong, surrogate, too large";
    EXPECT_EQ(readable_name("a\x1b[2J\xc2\x9b"), "a?[2J??");
    EXPECT_EQ(readable_name(""), "");
}

TEST(BoardInfo, SketchAndServicesBeyondAscii_AreShown) {
    EXPECT_EQ(parse_board_info("0,4,ATmega328P,20,T\xc3\xbcr, links")->sketch, "T\xc3\xbcr, links");
    EXPECT_EQ(parse_service_names("2,{D:K\xfc"
                                  "che,S:Servos}")
                  ->at(0)
                  .name,
              "K?che");
}

TEST(BoardInfo, DamagedAnswer_IsRefused) {
    for (const std::string_view body :
         {"", "0,4", "0,4,X", "a,4,X,20,S", "0,b,X,20,S", "0,4,X,257,S", "0,4,X,-1,S", "0,4,,20,S"}) {
        EXPECT_FALSE(parse_board_info(body)) << body;
    }
}

TEST(ServiceNames, Answer_IsRead) {
    EXPECT_THAT(parse_service_names("3,{I:ASIP core IO,S:Servos,D:Distance}").value(),
                ElementsAre(ServiceName{'I', "ASIP core IO"}, ServiceName{'S', "Servos"},
                            ServiceName{'D', "Distance"}));
    EXPECT_THAT(parse_service_names("2{I,S:}").value(),
                ElementsAre(ServiceName{'I', ""}, ServiceName{'S', ""}));
}

TEST(ServiceNames, DamagedAnswer_IsRefused) {
    for (const std::string_view body : {"", "1,{}", "1,{i:x}", "1,{IO}", "2,{I:x}"})
        EXPECT_FALSE(parse_service_names(body)) << body;
}

TEST(PinOwners, EachPin_IsOneCharacter) {
    EXPECT_EQ(parse_pin_owners("4,{@,I,S,D}").value(), "@ISD");
}

TEST(PinOwners, UnreadableOwner_IsADash) {
    EXPECT_EQ(parse_pin_owners("5,{@,I,S,?,xy}").value(), "@IS--");
}

TEST(PinModes, UnknownNumber_IsInvalid) {
    EXPECT_THAT(parse_pin_modes("4,{6,1,3,77}").value(),
                ElementsAre(PinMode::kReserved, PinMode::kInput, PinMode::kOutput, PinMode::kInvalid));
    EXPECT_FALSE(parse_pin_modes("1,{x}"));
}

TEST(PinCapabilities, Bits_AreKeptToThoseKnown) {
    EXPECT_THAT(parse_pin_capabilities("3,{1,5,255}").value(), ElementsAre(1, 5, 7));
    EXPECT_FALSE(parse_pin_capabilities("1,{256}"));
}

TEST(AnalogMap, Answer_IsPinAndChannel) {
    EXPECT_THAT(parse_analog_map("2,{14:0,15:1}").value(), ElementsAre(Pair(14, 0), Pair(15, 1)));
    for (const std::string_view body : {"1,{14}", "1,{14:x}", "1,{256:0}", "1,{-1:0}"})
        EXPECT_FALSE(parse_analog_map(body)) << body;
}

TEST(Extensions, Answer_IsTagsAndVersions) {
    EXPECT_EQ(parse_extensions("5,{E:1,I:1,B:2,C:1,L:172}")->longest_request(), 172u);
    EXPECT_EQ(parse_extensions("1,{L:9}")->longest_request(), 62u);
    EXPECT_EQ(parse_extensions("1,{L:255}")->longest_request(), 250u);
    const auto extensions = parse_extensions("4,{E:1,I:1,B:2,C:1}");
    EXPECT_EQ(extensions->longest_request(), 62u);
    ASSERT_TRUE(extensions);
    EXPECT_TRUE(extensions->has(kEcho));
    EXPECT_EQ(extensions->version(kLineRate), 2);
    EXPECT_FALSE(extensions->has('Z'));
}

TEST(Extensions, DamagedAnswer_IsRefused) {
    for (const std::string_view body : {"", "1,{E}", "1,{EE:1}", "1,{E:x}", "1,{E:256}", "1,{:1}"})
        EXPECT_FALSE(parse_extensions(body)) << body;
}

}  // namespace
}  // namespace asip::protocol
