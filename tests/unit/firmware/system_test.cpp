// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "fake_board.hpp"

namespace asip {
namespace {

class Lamp : public Service {
  public:
    Lamp() : Service('X') {}
    FlashText name() const override { return F("Lamp"); }
    void begin() override {
        ++begun;
        claimed = board.claimPin(7, *this);
    }
    Error processRequest(Request&) override { return Error::kUnknownRequest; }
    int begun = 0;
    Error claimed = Error::kNone;
};

TEST(SystemTest, ArgumentsWhereNoneBelong_AreRefused) {
    FakeBoard board;
    EXPECT_EQ(board.ask("#,?,1"), "~#,?,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.ask("#,R,"), "~#,R,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.ask("I,p,3"), "~I,p,11{BAD_ARGUMENT}\n");
}

TEST(SystemTest, Restart_PutsPinsAndAutoEventsBackInStep) {
    Lamp lamp;
    FakeBoard board({&lamp});
    board.ask("I,P,13,3");
    board.ask("I,d,13,1");
    board.ask("I,P,3,5");
    board.ask("I,a,3,99");
    board.ask("I,A,20");
    EXPECT_EQ(board.ask("#,R"), "");
    EXPECT_EQ(lamp.begun, 2);
    EXPECT_EQ(lamp.claimed, Error::kNone);
    EXPECT_EQ(board.hardware().modes[13], hw::FakeMode::kInput);
    EXPECT_EQ(board.hardware().duty[3], -1);
    EXPECT_EQ(board.ask("I,p"), "@I,p,20,{6,6,1,1,1,1,1,7,1,1,1,1,1,1,4,4,4,4,4,4}\n");
    EXPECT_EQ(board.pass_time(1000), "");
}

TEST(SystemTest, PinThatIsTaken_CannotBeClaimedAgain) {
    Lamp first, second;
    FakeBoard board({&first, &second});
    EXPECT_EQ(first.claimed, Error::kNone);
    EXPECT_EQ(second.claimed, Error::kInvalidPin);
    EXPECT_TRUE(asip::board.ownsPin(7, first));
    EXPECT_FALSE(asip::board.ownsPin(7, second));
    EXPECT_FALSE(asip::board.canClaim(0, first));
    EXPECT_FALSE(asip::board.canClaim(20, first));
}

TEST(SystemTest, ReleasedPin_IsAFreeInputAgain) {
    Lamp lamp;
    FakeBoard board({&lamp});
    asip::board.releasePins(lamp);
    EXPECT_EQ(board.ask("#,S"), "@#,S,20,{@,@,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I,I}\n");
    EXPECT_EQ(board.ask("I,P,7,1"), "@I,d,4,0\n");
}

TEST(SystemTest, StrictMode_LeavesEveryFreePinUnallocatedAndSilent) {
    FakeBoard board({}, true);
    EXPECT_EQ(board.ask("I,p"), "@I,p,20,{6,6,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0}\n");
    board.hardware().levels[2] = true;
    EXPECT_EQ(board.pass_time(1000), "");
}

}  // namespace
}  // namespace asip
