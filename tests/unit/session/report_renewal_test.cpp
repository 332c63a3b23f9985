// SPDX-License-Identifier: Apache-2.0
// A board of ASIP 0.4 that stops reporting as real ones do, over more than two turns of its 16-bit clock.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tests/unit/session/board_session_bench.hpp"

namespace asip::session {
namespace {

/// What makes the reports stop.
enum class Stop {
    kClockWraps,  ///< the next report is due behind the end of the clock, which counts from the board's start
    kAge,         ///< the period was set 65.5 s ago
    kNever,
};

/// Reports the distance as `D,A,ms` asks for it, or its analog pins as `I,A,ms` does. Time in milliseconds.
class ReportingBoard {
  public:
    ReportingBoard(Bench& bench, Stop stop, long clock, char service = 'D', long period = 0)
        : bench_(bench),
          stop_(stop),
          request_({service, ',', 'A', ','}),
          event_(service == 'D' ? "@D,e,1,{42}\r\n" : "@I,a,1,{0:42}\r\n"),
          clock_(clock),
          period_(period) {}

    void pass(long ms) {
        for (; ms > 0; ms -= kStep) {
            bench_.pass(std::chrono::milliseconds(kStep));
            clock_ += kStep;
            ++quiet_;
            read_requests();
            const bool reachable =
                stop_ == Stop::kNever || (stop_ == Stop::kClockWraps ? due_ < 65536 : clock_ - set_ < 65536);
            const long now = stop_ == Stop::kClockWraps ? clock_ % 65536 : clock_;
            if (period_ == 0 || !reachable || now < due_) continue;
            due_ = now + period_;
            most_quiet_ = std::max(most_quiet_, quiet_ * kStep);
            quiet_ = 0;
            ++reports_;
            bench_.say(event_);
        }
    }
    int reports() const { return reports_; }
    int asked() const { return asked_; }
    long most_quiet() const { return most_quiet_; }

  private:
    static constexpr long kStep = 50;

    void read_requests() {
        auto& executed = bench_.board.executed;
        for (; read_ < executed.size(); ++read_) {
            if (!executed[read_].starts_with(request_)) continue;
            ++asked_;
            period_ = std::atol(executed[read_].c_str() + 4);
            set_ = clock_;
            due_ = (stop_ == Stop::kClockWraps ? clock_ % 65536 : clock_) + period_;
        }
    }

    Bench& bench_;
    Stop stop_;
    std::string request_, event_;
    long clock_, period_, set_ = 0, due_ = 0, quiet_ = 0, most_quiet_ = 0;
    int reports_ = 0, asked_ = 0;
    std::size_t read_ = 0;
};

class Renewal : public OldBoard {
  protected:
    void SetUp() override { ASSERT_TRUE(bench.start()); }
};

TEST_F(Renewal, BoardWhosePeriodEnds_IsAskedBeforeThatAndReportsOn) {
    ReportingBoard board(bench, Stop::kAge, 0);
    bench.request("D,A,100");
    board.pass(200'000);
    EXPECT_GE(board.reports(), 1900);
    EXPECT_LE(board.most_quiet(), 250) << "no value is missing";
    EXPECT_LE(board.asked(), 8);
}

TEST_F(Renewal, BoardWhoseClockWrapsWithoutWarning_IsAskedAsSoonAsReportsAreMissing) {
    ReportingBoard board(bench, Stop::kClockWraps, 40'000);
    bench.request("D,A,100");
    board.pass(200'000);
    EXPECT_GE(board.reports(), 1900);
    EXPECT_LE(board.most_quiet(), 1000);
    EXPECT_LE(board.asked(), 12);
}

TEST_F(Renewal, PeriodLongerThanTheClock_IsNotPutOff) {
    ReportingBoard board(bench, Stop::kNever, 0);
    bench.request("D,A,65000");
    board.pass(330'000);
    EXPECT_GE(board.reports(), 4);
}

TEST_F(Renewal, AnalogReportsThatNobodyAskedFor_GoOnAtThePeriodThatTheyHad) {
    ReportingBoard board(bench, Stop::kClockWraps, 40'000, 'I', 50);
    board.pass(200'000);
    EXPECT_GE(board.reports(), 3800);
    EXPECT_LE(board.most_quiet(), 1000);
    EXPECT_LE(board.asked(), 12);
    const auto& executed = bench.board.executed;
    EXPECT_EQ(std::count_if(executed.begin(), executed.end(),
                            [](const std::string& line) { return line.starts_with("I,A,"); }),
              std::count(executed.begin(), executed.end(), "I,A,50"));
}

TEST_F(Renewal, AnalogReportsThatEndWithARestartByAClient_AreNotAskedForAgain) {
    ReportingBoard board(bench, Stop::kNever, 0, 'I', 50);
    board.pass(10'000);
    bench.request("#,R");
    bench.pass(5min);
    EXPECT_EQ(board.asked(), 0);
    const auto& executed = bench.board.executed;
    EXPECT_EQ(std::count(executed.begin(), executed.end(), "I,A,50"), 0);
}

TEST_F(Renewal, AFewAnalogReports_AreNoPeriod) {
    for (int i = 0; i < 10; ++i) {
        bench.say("@I,a,1,{0:42}\r\n");
        bench.pass(50ms);
    }
    bench.pass(5min);
    for (const auto& line : bench.board.executed)
        EXPECT_FALSE(line.starts_with("I,A,")) << line;
}

TEST_F(Renewal, ReportsThatHadWaited_AreNoPeriod) {
    ReportingBoard board(bench, Stop::kNever, 0, 'I', 50);
    board.pass(3000);
    bench.now += 1500ms;  // this program is not run
    for (int i = 0; i < 30; ++i)
        bench.say("@I,a,1,{0:42}\r\n");
    board.pass(150);
    bench.pass(5min);
    const auto& executed = bench.board.executed;
    const auto all = std::count_if(executed.begin(), executed.end(),
                                   [](const std::string& line) { return line.starts_with("I,A,"); });
    EXPECT_GE(all, 1) << "what was measured before is known, and the reports have ended";
    EXPECT_EQ(all, std::count(executed.begin(), executed.end(), "I,A,50"));
}

TEST_F(Renewal, ReportsThatWereTurnedOff_AreNotAskedForAgain) {
    ReportingBoard board(bench, Stop::kClockWraps, 0);
    bench.request("D,A,100");
    board.pass(1000);
    bench.request("D,A,0");
    board.pass(1000);
    const int asked = board.asked();
    board.pass(150'000);
    EXPECT_EQ(board.asked(), asked);
}

TEST_F(Renewal, ServiceThatNeverReports_IsAskedMoreAndMoreRarely) {
    bench.request("S,A,100");
    bench.pass(10min);
    const auto asked = std::count(bench.board.executed.begin(), bench.board.executed.end(), "S,A,100");
    EXPECT_GE(asked, 2);
    EXPECT_LE(asked, 20);
}

TEST(RenewalOfAny, ReportsThatWaitedInThePort_SetNoPeriod) {
    for (const bool extensions : {false, true}) {
        Bench bench;
        bench.board.extensions = extensions;
        bench.plug();
        for (int i = 0; i < 60; ++i)
            bench.say("@I,a,1,{0:42}\r\n");
        ASSERT_TRUE(bench.ready_within());
        bench.pass(5min);
        for (const auto& line : bench.board.executed)
            EXPECT_FALSE(line.starts_with("I,A,")) << line << ", extensions: " << extensions;
    }
}

TEST(RenewalOfOurs, BoardWithExtensions_IsNotAsked) {
    ReadyBench bench;
    bench.request("D,A,100");
    bench.pass(5min);
    EXPECT_EQ(std::count(bench.board.executed.begin(), bench.board.executed.end(), "D,A,100"), 1);
}

}  // namespace
}  // namespace asip::session
