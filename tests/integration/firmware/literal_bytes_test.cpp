// SPDX-License-Identifier: Apache-2.0
// The table of literal bytes on the robot's image in the simulator: pins, PWM and reports are the same as
// after the requests that ASIP 0.4 executes, with line ends.
#include <gtest/gtest.h>

#include <set>

#include "firmware_board.hpp"
#include "tests/literal/literal_table.hpp"

namespace asip::firmware {
namespace {

using std::chrono::milliseconds;

/// A board that nothing was asked of but `#,R`, whose peer left it as an agent does.
class Uno {
  public:
    Uno() : board_("asip_uno_mirto") {
        board_->send("#,B,57600\n");
        board_->run_for(milliseconds(20));
        board_->take_output();
    }
    void write(const std::string& bytes) {
        board_->send(bytes);
        board_->run_for(milliseconds(30));
    }
    void silence() { board_->run_for(milliseconds(1100)); }
    /// Levels, PWM of timers 0 and 2 (the servo has timer 1), and which reports come.
    std::string state() {
        std::string text;
        for (int pin = 2; pin < 18; ++pin)
            text += board_->pin(pin) == sim::Level::kHigh ? '1' : '0';
        for (const std::uint16_t address : {0x44, 0x47, 0x48, 0xB0, 0xB3, 0xB4})
            text += ' ' + std::to_string(board_->peek(address));
        std::set<std::string> reports;
        for (const auto& line : board_.lines_within(milliseconds(400)))
            reports.insert(line.substr(0, 4));
        for (const auto& report : reports)
            text += ' ' + report;
        return text;
    }

  private:
    FirmwareBoard board_;
};

TEST(LiteralBytesOnBoard, EachRow_HasTheEffectThatItHasOn04) {
    for (const auto& row : test::literal_rows("serial")) {
        Uno literal, whole;
        for (const auto& write : row.writes)
            literal.write(write);
        literal.silence();
        for (const auto& request : row.executes)
            whole.write(request + "\n");
        whole.silence();
        EXPECT_EQ(literal.state(), whole.state()) << row.name();
    }
}

TEST(LiteralBytesOnBoard, MotorsOfPythonAsip_AreDrivenWithoutALineEnd) {
    Uno uno;
    const auto before = uno.state();
    uno.write("M,m,1,100");
    EXPECT_EQ(uno.state(), before) << "it may go on";
    uno.write("M,m,0,-100");
    EXPECT_NE(uno.state(), before);
}

}  // namespace
}  // namespace asip::firmware
