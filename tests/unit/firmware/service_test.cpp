#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace asip
