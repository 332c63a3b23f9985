#include "asip/program/nearest.hpp"

#include <gtest/gtest.h>

namespace asip::program {
namespace {

TEST(EditDistance, KnownPairs_AreCounted) {
    EXPECT_EQ(edit_distance("", ""), 0u);
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    EXPECT_EQ(edit_distance("servo", "Servo"), 0u);
    EXPECT_EQ(edit_distance("servo", "sevro"), 1u);
    EXPECT_EQ(edit_distance("distance", "distnce"), 1u);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(Nearest, NearWord_IsFound) {
    EXPECT_EQ(nearest("distnace", {"servo", "distance"}), "distance");
    EXPECT_EQ(nearest("on", {"io", "in"}), "in");
    EXPECT_EQ(did_you_mean("sevro", {"servo"}), " (did you mean \"servo\"?)");
}

TEST(Nearest, NothingNear_IsNothing) {
    EXPECT_EQ(nearest("distance", {"servo", "io"}), std::nullopt);
    EXPECT_EQ(nearest("x", {}), std::nullopt);
    EXPECT_EQ(did_you_mean("bogus", {"distance"}), "");
}

}  // namespace
}  // namespace asip::program
