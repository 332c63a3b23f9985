// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/port_map.hpp"

#include <gmock/gmock.h>

namespace asip::protocol {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(PortMap, MaskIsHexadecimal_PortIsDecimal) {
    const auto map = PortMap::parse("3,{4:1,10:80,4:10}");
    ASSERT_TRUE(map);
    EXPECT_THAT(map->levels({4, 0x10}), ElementsAre(PinLevel{0, false}, PinLevel{2, true}));
    EXPECT_THAT(map->levels({10, 0x80}), ElementsAre(PinLevel{1, true}));
}

TEST(PortMap, PortWithoutPins_HasNoLevels) {
    EXPECT_THAT(PortMap::parse("1{4:1}")->levels({5, 0xff}), IsEmpty());
}

TEST(PortMap, PinOnNoPort_IsInNoEvent) {
    EXPECT_THAT(PortMap::parse("2,{0:0,0:1}")->levels({0, 1}), ElementsAre(PinLevel{1, true}));
}

TEST(PortMap, DamagedAnswer_IsRefused) {
    for (const std::string_view body :
         {"", "2,{4:1}", "1,{4}", "1,{4:1:1}", "1,{:1}", "1,{4:}", "1,{4:g}", "1,{256:1}", "1,{-1:1}"}) {
        EXPECT_FALSE(PortMap::parse(body)) << body;
    }
}

TEST(PortState, PortAndHexMask_AreRead) {
    const auto state = parse_port_state("4,2c");
    ASSERT_TRUE(state);
    EXPECT_EQ(state->port, 4);
    EXPECT_EQ(state->levels, 0x2cu);
}

TEST(PortState, DamagedEvent_IsRefused) {
    for (const std::string_view body : {"", "4", "4,", ",2c", "4,2c,1", "4,2c\r", "x,1", "4,0x1", "300,1"})
        EXPECT_FALSE(parse_port_state(body)) << body;
}

}  // namespace
}  // namespace asip::protocol
