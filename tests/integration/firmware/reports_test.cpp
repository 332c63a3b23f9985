// SPDX-License-Identifier: Apache-2.0
// Reports of several services on one line: none is silenced, none drifts.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "firmware_board.hpp"

namespace asip::firmware {
namespace {

using namespace std::chrono_literals;

constexpr const char* kReportsImage = "asip_uno_robot";

TEST(ReportsTest, ServiceThatIsAlwaysDue_DoesNotSilenceTheOthers) {
    FirmwareBoard board(kReportsImage);
    for (const char* request : {"E,A,1", "B,A,25", "R,A,25"})
        board.ask(request);
    std::map<char, int> events;
    for (const auto& line : board.lines_within(1000ms))
        ++events[line[1]];
    EXPECT_GE(events['B'], 38);
    EXPECT_GE(events['R'], 38);
    EXPECT_GE(events['E'], 100);
}

TEST(ReportsTest, EverySensorAt25MillisecondsAt500000Baud_EachComesAtItsTime) {
    FirmwareBoard board(kReportsImage);
    board.step_up(500000);
    for (const char* request : {"E,A,25", "B,A,25", "R,A,25", "I,A,25"})
        board.ask(request);
    std::map<char, std::vector<double>> times;
    const auto end = board->now() + 2s;
    while (board->now() < end) {
        const auto line = board->read_line(100ms);
        ASSERT_TRUE(line);
        times[line->text[1]].push_back(static_cast<double>(line->cycle) / 16000);
    }
    for (const char id : {'E', 'B', 'R', 'I'}) {
        const auto& at = times[id];
        ASSERT_GE(at.size(), 78u) << id;
        std::vector<double> offsets;
        for (std::size_t i = 0; i < at.size(); ++i)
            offsets.push_back(at[i] - 25.0 * static_cast<double>(i));
        std::sort(offsets.begin(), offsets.end());
        const double usual = offsets[offsets.size() / 2];
        EXPECT_LE(usual - offsets.front(), 2) << id;
        EXPECT_LE(offsets.back() - usual, 2) << id;
    }
}

TEST(ReportsTest, ReflectanceWhoseEmitterPinIsTaken_IsNotAvailable) {
    FirmwareBoard board("asip_uno_conflict");
    EXPECT_EQ(board.ask("R,A,20"), "~R,A,8{DEVICE_NOT_AVAILABLE}");
    EXPECT_EQ(board.ask("R,M"), "~R,M,2{UNKNOWN_REQUEST}");
    EXPECT_TRUE(board.lines_within(100ms).empty());
}

}  // namespace
}  // namespace asip::firmware
