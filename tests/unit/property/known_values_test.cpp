// SPDX-License-Identifier: Apache-2.0
// How a board stands: by what it reports and which commands it executed.
#include "asip/property/known_values.hpp"

#include "tests/unit/property/boards.hpp"

namespace asip::property::test {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

class KnownValuesTest : public testing::Test {
  protected:
    void use(const model::Description& board) {
        board_ = board;
        known_.use(properties(board_), now_);
    }
    bool execute(const std::string& service, const std::string& line, bool perhaps = false) {
        const auto model = model::ModelSet::standard().find(service);
        const auto request = model::request_values(*model, line);
        EXPECT_TRUE(request) << line;
        return request && known_.executed(service, *request, perhaps, now_);
    }
    Known of(const std::string& id) {
        for (std::size_t i = 0; i < known_.properties().size(); ++i)
            if (known_.properties()[i].id == id) return known_.known(i);
        ADD_FAILURE() << "no property " << id;
        return {};
    }
    json value(const std::string& id) { return of(id).value; }

    Time now_{1000s};
    model::Description board_;
    KnownValues known_;
};

TEST_F(KnownValuesTest, Command_SetsTheValueOfItsElement) {
    use(board_with({"servo"}));
    EXPECT_EQ(of("servo/0/angle").how, How::kNone);
    EXPECT_TRUE(execute("servo", "W,0,150"));
    EXPECT_EQ(value("servo/0/angle"), 150);
    EXPECT_EQ(of("servo/0/angle").how, How::kSet);
    EXPECT_FALSE(execute("servo", "W,0,150")) << "nothing but the time changed";
}

TEST_F(KnownValuesTest, CommandInDoubt_LeavesTheValueUnknown) {
    use(board_with({"servo"}));
    execute("servo", "W,0,150");
    EXPECT_TRUE(execute("servo", "W,0,20", true));
    EXPECT_EQ(of("servo/0/angle").how, How::kNone);
    EXPECT_EQ(of("servo/0/angle").why, Unknown::kDoubt);
}

TEST_F(KnownValuesTest, DriveAndStop_SetThePowerOfTheMotors) {
    use(board_with({"motors"}));
    execute("motors", "M,10,-20");
    EXPECT_EQ(value("motors/0/power"), 10);
    EXPECT_EQ(value("motors/1/power"), -20);
    execute("motors", "s,1");
    EXPECT_EQ(value("motors/0/power"), 10);
    EXPECT_EQ(value("motors/1/power"), 0);
    execute("motors", "S");
    EXPECT_EQ(value("motors/0/power"), 0);
}

TEST_F(KnownValuesTest, Tone_IsSilentAfterItsSafeForm) {
    use(board_with({"tone"}));
    execute("tone", "P,440,500");
    EXPECT_EQ(value("tone/frequency"), 440);
    execute("tone", "P,0,0");
    EXPECT_EQ(value("tone/frequency"), 0);
}

TEST_F(KnownValuesTest, ModeOfAPin_EndsWhatWasWritten) {
    auto board = board_with({"io"});
    board.labels.modes = {{13, 3}};
    use(board);
    execute("io", "d,13,1");
    EXPECT_EQ(value("io/13"), true);
    execute("io", "P,13,3");
    EXPECT_EQ(of("io/13").how, How::kNone);
}

TEST_F(KnownValuesTest, LevelOfANewInput_IsKnownAlsoWhenItCameBeforeTheProof) {
    auto board = board_with({"io"});
    use(board);
    known_.input_begins("io", 2);
    known_.reported("io", {{"digital", {{"2", 1}}}}, How::kReported, now_);
    board.labels.modes = {{2, 1}};
    use(board);
    EXPECT_FALSE(known_.input_began("io", 2, now_));
    EXPECT_EQ(value("io/2"), true);
}

TEST_F(KnownValuesTest, NewInputWithoutAnEvent_IsLow) {
    auto board = board_with({"io"});
    board.labels.modes = {{2, 2}};
    use(board);
    known_.input_begins("io", 2);
    EXPECT_TRUE(known_.input_began("io", 2, now_));
    EXPECT_EQ(value("io/2"), true) << "with a pull-up low means on";
}

/// A port says the levels of all its pins at once; those that are no inputs are low there.
TEST_F(KnownValuesTest, PinThatFloats_HasNoValueUntilItIsAnInput) {
    for (const auto* klass : {"button", "door", "motion"}) {
        auto board = board_with({"io"});
        board.labels.modes[3] = 2;
        board.labels.meanings["io/2"].klass = klass;
        use(board);
        known_.reported("io", {{"digital", {{"2", 0}, {"3", 1}}}}, How::kReported, now_);
        EXPECT_EQ(of("io/2").how, How::kNone) << klass;
        EXPECT_EQ(value("io/3"), false);
        known_.input_begins("io", 2);
        known_.reported("io", {{"digital", {{"2", 1}, {"3", 1}}}}, How::kReported, now_);
        EXPECT_EQ(of("io/2").how, How::kNone) << "the board did not confirm the mode yet";
        board.labels.modes[2] = 2;
        use(board);
        EXPECT_FALSE(known_.input_began("io", 2, now_));
        EXPECT_EQ(value("io/2"), false) << "released";
        known_.reported("io", {{"digital", {{"2", 0}}}}, How::kReported, now_);
        EXPECT_EQ(value("io/2"), true);
        board.labels.modes[2] = 3;
        use(board);
        EXPECT_EQ(of("io/2").how, How::kNone) << "an output";
        known_ = KnownValues();
    }
}

TEST_F(KnownValuesTest, AnotherMeaning_ShowsTheSameLevelAnew) {
    auto board = board_with({"io"});
    board.labels.modes = {{2, 1}};
    use(board);
    known_.reported("io", {{"digital", {{"2", 0}}}}, How::kReported, now_);
    EXPECT_EQ(value("io/2"), false);
    board.labels.meanings["io/2"].inverted = true;
    use(board);
    EXPECT_EQ(value("io/2"), true);
}

TEST_F(KnownValuesTest, Restart_LeavesNothingKnown) {
    use(board_with({"distance", "servo"}));
    execute("servo", "W,0,10");
    known_.reported("distance", {{"distance", {42}}}, How::kReported, now_);
    EXPECT_EQ(value("distance/0"), 42);
    EXPECT_TRUE(known_.forget(now_));
    EXPECT_EQ(of("distance/0").why, Unknown::kRestart);
    EXPECT_EQ(of("servo/0/angle").why, Unknown::kRestart);
}

TEST_F(KnownValuesTest, ValueOutsideOfItsBounds_ChangesNothing) {
    use(board_with({"distance"}));
    known_.reported("distance", {{"distance", {42}}}, How::kReported, now_);
    EXPECT_FALSE(known_.reported("distance", {{"distance", {401}}}, How::kReported, now_));
    EXPECT_EQ(value("distance/0"), 42);
}

TEST_F(KnownValuesTest, Encoder_ShowsTheSum) {
    use(board_with({"encoders"}));
    known_.reported("encoders", {{"encoders", {{{"pulse", 1}, {"count", 3}}}}}, How::kReported, now_);
    known_.reported("encoders", {{"encoders", {{{"pulse", 1}, {"count", -1}}}}}, How::kReported, now_);
    EXPECT_EQ(value("encoders/0/count"), 2);
}

TEST_F(KnownValuesTest, BrightnessOfAStrip_IsItsLight) {
    use(board_with({"pixels"}));
    execute("pixels", "B,128");
    EXPECT_EQ(value("pixels/light")["on"], true);
    execute("pixels", "B,0");
    EXPECT_EQ(value("pixels/light")["on"], false);
}

}  // namespace
}  // namespace asip::property::test
