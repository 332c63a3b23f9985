// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>

#include "fake_board.hpp"

namespace asip {
namespace {

class Counter : public Service {
  public:
    explicit Counter(std::uint8_t values = 2) : Service('C', values) {}
    FlashText name() const override { return F("Counter"); }
    void begin() override { resets += 1; }
    Error processRequest(Request& request) override {
        if (request.tag() != 'M') return Error::kUnknownRequest;
        if (!request.complete()) return Error::kBadArgument;
        reportValues();
        return Error::kNone;
    }
    void reportValue(std::uint8_t index) override { out.number(static_cast<std::uint16_t>(index + 40)); }
    void poll() override { ++polls; }
    int resets = 0;
    int polls = 0;
};

std::size_t lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(ServiceTest, Report_HasCountAndEveryValue) {
    Counter counter;
    FakeBoard board({&counter});
    EXPECT_EQ(board.ask("C,M"), "@C,e,2,{40,41}\n");
    EXPECT_EQ(board.ask("C,q"), "~C,q,2{UNKNOWN_REQUEST}\n");
}

TEST(ServiceTest, EachPass_PollsEachService) {
    Counter counter;
    FakeBoard board({&counter});
    const int before = counter.polls;
    asip::board.run();
    asip::board.run();
    EXPECT_EQ(counter.polls, before + 2);
}

TEST(ServiceTest, AutoEventPeriod_IsKeptByTheCore) {
    Counter counter;
    FakeBoard board({&counter});
    EXPECT_EQ(board.ask("C,A,10"), "");
    EXPECT_EQ(lines(board.pass_time(100)), 10u);
    EXPECT_EQ(board.ask("C,A,x"), "~C,A,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(board.ask("C,A"), "~C,A,11{BAD_ARGUMENT}\n");
    EXPECT_EQ(lines(board.pass_time(100)), 10u);
    EXPECT_EQ(board.ask("C,A,0"), "");
    EXPECT_EQ(board.pass_time(100), "");
}

TEST(ServiceTest, ServiceWithoutValues_HasNoAutoEvents) {
    Counter silent(0);
    FakeBoard board({&silent});
    EXPECT_EQ(board.ask("C,A,10"), "~C,A,2{UNKNOWN_REQUEST}\n");
}

TEST(ServiceTest, LongestPeriod_HoldsOverTheWrapOf16Bits) {
    Counter counter;
    FakeBoard board({&counter});
    board.ask("C,A,65535");
    EXPECT_EQ(board.pass_time(65534), "");
    EXPECT_EQ(lines(board.pass_time(2)), 1u);
    EXPECT_EQ(board.pass_time(65532), "");
    EXPECT_EQ(lines(board.pass_time(4)), 1u);
}

TEST(ServiceTest, ShortPeriod_KeepsItsPaceForMinutes) {
    Counter counter(1);
    FakeBoard board({&counter});
    board.ask("C,A,100");
    EXPECT_EQ(lines(board.pass_time(200000)), 2000u);
}

TEST(ServiceTest, ReportThatFindsTheLineFull_ComesLater) {
    Counter counter;
    FakeBoard board({&counter});
    board.ask("C,A,5");
    for (int ms = 0; ms < 20; ++ms) {
        board.hardware().room = 0;
        ++board.hardware().milliseconds;
        asip::board.run();
        ASSERT_EQ(board.hardware().from_board, "");
    }
    board.hardware().room = 63;
    EXPECT_EQ(board.pass_time(1), "@C,e,2,{40,41}\n");
}

TEST(ServiceTest, InfoInTheMiddleOfAList_ComesAfterIt) {
    Counter counter;
    FakeBoard board({&counter});
    board.hardware().to_board = "C,M\n";
    asip::board.run();
    asip::board.info(F("hello"));
    EXPECT_EQ(board.settle(), "@C,e,2,{40,41}\n!hello\n");
}

// 3 bytes leave the line in each millisecond.
std::string pass_time_on_a_slow_line(FakeBoard& board, unsigned milliseconds) {
    std::string all;
    auto& fake = board.hardware();
    for (unsigned ms = 0; ms < milliseconds; ++ms) {
        ++fake.milliseconds;
        for (int pass = 0; pass < 10; ++pass)
            asip::board.run();
        fake.room = std::min<std::size_t>(63, fake.room + 3);
        all += std::exchange(fake.from_board, {});
    }
    return all;
}

TEST(ServiceTest, FloodOfBadRequests_NeverWaitsForTheLine) {
    FakeBoard board;
    for (int i = 0; i < 100; ++i)
        board.hardware().to_board += "Z,x\n";
    const auto sent = pass_time_on_a_slow_line(board, 1000);
    EXPECT_EQ(lines(sent), 100u);
    EXPECT_EQ(board.hardware().waits, 0u);
}

TEST(ServiceTest, ReportThatWasLate_IsFollowedByTheNextInItsPace) {
    Counter counter;
    FakeBoard board({&counter});
    board.ask("C,A,10");
    board.pass_time(9);
    for (int ms = 0; ms < 6; ++ms) {
        board.hardware().room = 0;
        ++board.hardware().milliseconds;
        asip::board.run();
    }
    board.hardware().room = 63;
    EXPECT_EQ(lines(board.pass_time(1)), 1u) << "due at 10, sent at 16";
    EXPECT_EQ(lines(board.pass_time(3)), 0u);
    EXPECT_EQ(lines(board.pass_time(1)), 1u) << "due at 20";
}

TEST(ServiceTest, PeriodShorterThanThePasses_ReportsInEachOfThem) {
    Counter counter;
    FakeBoard board({&counter});
    board.ask("C,A,2");
    for (int pass = 0; pass < 5; ++pass) {
        board.hardware().milliseconds = static_cast<std::uint8_t>(board.hardware().milliseconds + 7);
        EXPECT_EQ(lines(board.settle()), 1u);
    }
}

TEST(ServiceTest, ServiceAddedTwice_IsThereOnce) {
    Counter counter, other;
    FakeBoard board({&counter, &counter, &other, &counter});
    EXPECT_EQ(board.ask("#,N"), "@#,N,3,{I:ASIP core IO,C:Counter,C:Counter}\n");
}

TEST(ServiceTest, SixteenthService_IsNotAdded) {
    std::array<Counter, 17> counters;
    std::vector<Service*> services;
    for (auto& counter : counters)
        services.push_back(&counter);
    FakeBoard board(services);
    EXPECT_EQ(board.ask("#,N").substr(0, 7), "@#,N,16");
    EXPECT_EQ(counters[14].resets, 1);
    EXPECT_EQ(counters[15].resets, 0);
}

}  // namespace
}  // namespace asip
