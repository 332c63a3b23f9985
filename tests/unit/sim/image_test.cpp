// SPDX-License-Identifier: Apache-2.0
#include "sim/chip/image.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "monitor.hpp"

namespace asip::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Expected<Image> hex(std::string_view text) {
    return parse_hex({text.begin(), text.end()}, "x.hex");
}

std::vector<std::uint8_t> sketch_bytes() {
    std::ifstream stream(SKETCH_FOLDER "/monitor_atmega328p.elf", std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(HexImage, Records_ArePlacedWithGapsErased) {
    const auto image = hex(":020000000102FB\r\n:02000400030 4F3\n");
    EXPECT_FALSE(image) << "a space is not a digit";
    const auto good = hex(":020000000102FB\r\n\n:020004000304F3\r\n:00000001FF\r\n");
    ASSERT_TRUE(good) << good.error();
    EXPECT_THAT(good->flash, ElementsAre(1, 2, 0xff, 0xff, 3, 4));
}

TEST(HexImage, ExtendedAddresses_AreFollowed) {
    const auto segment = hex(":020000021000EC\n:0100000007F8\n:00000001FF\n");
    ASSERT_TRUE(segment) << segment.error();
    EXPECT_EQ(segment->flash.size(), 0x10001u);
    const auto linear = hex(":020000040001F9\n:0100000007F8\n:00000001FF\n");
    ASSERT_TRUE(linear) << linear.error();
    EXPECT_EQ(linear->flash.back(), 7);
}

TEST(HexImage, WrongRecord_NamedByItsLine) {
    EXPECT_THAT(hex(":020000000102FB\n:020004000304F2\n:00000001FF\n").error(), HasSubstr("x.hex:2:"));
    EXPECT_THAT(hex(":0200000001FB\n").error(), HasSubstr("x.hex:1:"));
    EXPECT_THAT(hex(":0\n").error(), HasSubstr("x.hex:1:"));
    EXPECT_THAT(hex(":020000000102FB\nhello\n").error(), HasSubstr("x.hex:2:"));
}

TEST(HexImage, WithoutEndOrContent_Refused) {
    EXPECT_THAT(hex(":020000000102FB\n").error(), HasSubstr("cut off"));
    EXPECT_THAT(hex(":00000001FF\n").error(), HasSubstr("no program"));
}

TEST(HexImage, AddressBeyondEveryAvr_Refused) {
    EXPECT_THAT(hex(":02000004FFFFFC\n:0100000007F8\n:00000001FF\n").error(), HasSubstr("fits no AVR"));
}

TEST(ElfImage, Sketch_HasFlashAndSymbols) {
    const auto image = parse_elf(sketch_bytes(), "x.elf");
    ASSERT_TRUE(image) << image.error();
    EXPECT_GT(image->flash.size(), 500u);
    EXPECT_EQ(image->symbols.count("main"), 1u);
    EXPECT_EQ(image->symbols.count("edges"), 1u);
}

TEST(ElfImage, CutAnywhere_RefusedOrReadButNeverOverrun) {
    const auto whole = sketch_bytes();
    for (std::size_t size = 0; size < whole.size(); size += 7) {
        const std::vector<std::uint8_t> part(whole.begin(),
                                             whole.begin() + static_cast<std::ptrdiff_t>(size));
        const auto image = parse_elf(part, "x.elf");
        EXPECT_TRUE(image.has_value() || image.error().starts_with("x.elf: "));
    }
}

TEST(ElfImage, AnyByteOfItsHeaderWrong_NeverOverrun) {
    const auto whole = sketch_bytes();
    for (std::size_t i = 0; i < 200; ++i)
        for (const std::uint8_t value : {0x00, 0x01, 0x7f, 0xff}) {
            auto damaged = whole;
            damaged[i] = value;
            (void)parse_elf(damaged, "x.elf");
        }
}

TEST(LoadImage, NeitherElfNorHex_Refused) {
    TemporaryFolder folder;
    write_file(folder / "sketch.ino", "void setup() {}");
    EXPECT_THAT(load_image(folder / "sketch.ino").error(), HasSubstr("neither an .elf nor an Intel .hex"));
    write_file(folder / "empty.elf", "");
    EXPECT_THAT(load_image(folder / "empty.elf").error(), HasSubstr("empty"));
    EXPECT_THAT(load_image(folder / "").error(), HasSubstr("is a folder"));
}

}  // namespace
}  // namespace asip::sim
