// SPDX-License-Identifier: Apache-2.0
#include "asip/text/nearest.hpp"

#include <gtest/gtest.h>

#include <array>
#include <ranges>
#include <vector>

namespace asip::text {
namespace {

using Words = std::vector<std::string>;

TEST(EditDistance, KnownPairs_AreCounted) {
    EXPECT_EQ(edit_distance("", ""), 0u);
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    EXPECT_EQ(edit_distance("servo", "Servo"), 0u);
    EXPECT_EQ(edit_distance("servo", "sevro"), 1u);
    EXPECT_EQ(edit_distance("distance", "distnce"), 1u);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(EditDistance, VeryLongTexts_CompareOnlyTheirBeginnings) {
    EXPECT_EQ(edit_distance(std::string(1'000'000, 'a'), std::string(1'000'000, 'a') + "b"), 0u);
}

TEST(Nearest, ThousandsOfNames_AreNotAllLookedAt) {
    std::size_t looked_at = 0;
    const Words names(10'000, "board-of-the-hall");
    const auto counted = std::views::transform(names, [&](const std::string& name) -> const std::string& {
        ++looked_at;
        return name;
    });
    EXPECT_EQ(nearest("board-of-no-house", counted), std::nullopt);
    EXPECT_LT(looked_at, 1000u);
    looked_at = 0;
    EXPECT_EQ(nearest(std::string(10'000, 'x'), counted), std::nullopt);
    EXPECT_LT(looked_at, 20u);
}

TEST(Nearest, Misspelling_IsFound) {
    EXPECT_EQ(nearest("distnace", Words{"servo", "distance"}), "distance");
    EXPECT_EQ(nearest("wirte", std::array<std::string_view, 2>{"remap", "write"}), "write");
    EXPECT_EQ(nearest("WRITE", Words{"write"}), "write");
    EXPECT_EQ(nearest("on", Words{"io", "in"}), "in");
    EXPECT_EQ(nearest("leed", Words{"led", "button"}), "led");
}

TEST(Nearest, BeginningOfAWord_IsFoundUnlessAnotherIsTheWord) {
    EXPECT_EQ(nearest("pot", Words{"potentiometer"}), "potentiometer");
    EXPECT_EQ(nearest("pot", Words{"potentiometer", "pot"}), "pot");
    EXPECT_EQ(nearest("po", Words{"potentiometer"}), std::nullopt);
}

TEST(Nearest, NothingNear_IsNothing) {
    EXPECT_EQ(nearest("distance", Words{"servo", "io"}), std::nullopt);
    EXPECT_EQ(nearest("x", Words{"y"}), std::nullopt);
    EXPECT_EQ(nearest("", Words{"a", ""}), std::nullopt);
    EXPECT_EQ(nearest("x", Words{}), std::nullopt);
}

TEST(Nearest, SeveralEquallyNear_GivesTheFirst) {
    EXPECT_EQ(nearest("uno3", Words{"uno1", "uno2"}), "uno1");
}

TEST(DidYouMean, NearAndFar_AreSentenceAndNothing) {
    EXPECT_EQ(did_you_mean("sevro", Words{"servo"}), " (did you mean \"servo\"?)");
    EXPECT_EQ(did_you_mean("bogus", Words{"distance"}), "");
}

}  // namespace
}  // namespace asip::text
