// SPDX-License-Identifier: Apache-2.0
// What docs/service-by-hand.md promises of the service it builds.
#include <gtest/gtest.h>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

TEST(AddAServiceTest, TheService_DoesWhatThePageShows) {
    FirmwareBoard board("asip_uno_fans", "uno", {{"square-wave", {{"pin", 2}, {"hertz", 40}}, "fan"}});
    EXPECT_EQ(board.ask("#,N"), "@#,N,2,{I:ASIP core IO,F:Fan}");
    EXPECT_EQ(board.ask("F,W,0,50"), "");
    EXPECT_EQ(board.ask("F,W,2,50"), "~F,W,7{INVALID_DEVICE_NUMBER}");
    EXPECT_EQ(board.ask("F,W,0,200"), "~F,W,11{BAD_ARGUMENT}");
    EXPECT_EQ(board.ask("F,q"), "~F,q,2{UNKNOWN_REQUEST}");
    board->run_for(std::chrono::milliseconds(2100));
    EXPECT_EQ(board.ask("F,M"), "@F,e,2,{1200,0}");
    EXPECT_EQ(board.ask("F,A,1000"), "");
    const auto lines = board.lines_within(std::chrono::milliseconds(3050));
    ASSERT_EQ(lines.size(), 3u);
    for (const auto& line : lines)
        EXPECT_EQ(line.substr(0, 8), "@F,e,2,{");
}

}  // namespace
}  // namespace asip::firmware
