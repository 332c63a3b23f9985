// SPDX-License-Identifier: Apache-2.0
// Whose turn it is: clients that ask much, boards that publish much, and stops between them. What a job costs
// is counted here, and no clock is read but in one test.
#include "asip/bus/shares.hpp"

#include <gmock/gmock.h>

#include <ctime>
#include <thread>

namespace asip::bus {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::ElementsAre;

class SharesTest : public testing::Test {
  protected:
    /// A job that costs so much in each of its steps.
    void job(const std::string& name, Duration cost, bool urgent = false, int steps = 1) {
        shares.add(
            name,
            [this, name, cost, left = steps]() mutable {
                used += cost;
                done.push_back(name);
                return --left > 0;
            },
            urgent);
    }
    void run() {
        while (shares.run()) {
        }
    }

    Duration used{};
    int woken = 0;
    std::vector<std::string> done;
    Shares shares{[this] { return used; }, [this] { ++woken; }};
};

TEST_F(SharesTest, ManyCostlyRequestsOfOneClient_KeepAnotherWaitingForOneOfThem) {
    for (int i = 0; i < 32; ++i)
        job("hog", 20ms);
    shares.run();
    for (int i = 0; i < 10; ++i)
        job("anna", 1ms);
    run();
    EXPECT_THAT(std::vector(done.begin() + 1, done.begin() + 11), Each("anna"));
    EXPECT_EQ(done.size(), 42u);
    EXPECT_EQ(woken, 1);
}

TEST_F(SharesTest, Stop_GoesAheadOfAllThatWaits_AlsoOfItsOwnClient) {
    for (int i = 0; i < 32; ++i)
        job("hog", 20ms);
    job("hog", 1ms, true);
    job("anna", 1ms);
    shares.run();
    EXPECT_THAT(done, ElementsAre("hog", "anna"));
    EXPECT_EQ(used, 2ms);
}

TEST_F(SharesTest, FloodOfStops_KeepsTheStopOfAnotherWaitingForOneOfThem) {
    for (int i = 0; i < 32; ++i)
        job("hog", 20ms, true);
    shares.run();
    job("anna", 1ms, true);
    shares.run();
    EXPECT_EQ(done[1], "anna");
}

TEST_F(SharesTest, FloodOfStops_DelaysRequestsOfOthersForABoundedTime_AndNoStopOfOthers) {
    for (int i = 0; i < 100; ++i)
        job("hog", 10ms, true);
    job("anna", 1ms);
    for (int i = 0; i < 6; ++i)
        shares.run();
    EXPECT_THAT(done, ElementsAre("hog", "hog", "hog", "hog", "hog", "anna", "hog"));
    job("bob", 1ms);
    job("olga", 1ms, true);
    shares.run();
    EXPECT_EQ(done[7], "olga");
    run();
    EXPECT_EQ(done.size(), 103u);
}

TEST_F(SharesTest, SlicesOfACostlyAnswer_LetOthersBetween_AndTheNextOfItsClientWait) {
    job("hog", 2ms, false, 3);
    job("hog", 100ms);
    shares.run();
    job("anna", 1ms);
    run();
    EXPECT_THAT(done, ElementsAre("hog", "anna", "hog", "hog", "hog"));
    EXPECT_EQ(used, 107ms);
}

TEST_F(SharesTest, Run_EndsWithItsSlice_AndForgetsWhoIsDone) {
    for (int i = 0; i < 100; ++i)
        job("client " + std::to_string(i), 1ms);
    EXPECT_TRUE(shares.run());
    EXPECT_EQ(used, Shares::kSlice);
    run();
    EXPECT_EQ(done.size(), 100u);
    EXPECT_EQ(shares.names(), 0u);
}

class BoardSharesTest : public SharesTest {
  protected:
    void message(const std::string& board, const std::string& topic, std::string payload) {
        mqtt::Message message{.topic = topic, .payload = std::move(payload)};
        boards.message(board, message, now);
    }

    Time now{};
    std::vector<std::string> handled;
    std::vector<std::string> replaced;
    BoardShares boards{shares,
                       [this](const mqtt::Message& message) {
                           used += 1ms;
                           handled.push_back(message.topic + " " + message.payload);
                       },
                       [this](const std::string& topic) { replaced.push_back(topic); }};
};

TEST_F(BoardSharesTest, FloodOfOneBoard_CostsItsShare_AndEndsWithItsLastMessage) {
    for (int i = 0; i < 10'000; ++i)
        message("hog", "state", std::to_string(i));
    EXPECT_EQ(handled.size(), 100u) << "kBurst";
    message("other", "value", "1");
    EXPECT_EQ(handled.back(), "value 1") << "of another board at once";
    job("anna", 1ms);
    run();
    EXPECT_EQ(done.size(), 1u);
    EXPECT_EQ(handled.back(), "state 9999");
    EXPECT_EQ(handled.size(), 102u);
    EXPECT_EQ(replaced.size(), 9899u);
    now += 1s;
    message("hog", "state", "at rest");
    EXPECT_EQ(handled.back(), "state at rest") << "it has a share again";
    boards.tick(now += 1s);
    EXPECT_EQ(boards.boards(), 0u);
}

TEST_F(BoardSharesTest, ConnectionLost_WhatWaitedIsForgotten_AndTheNextMessageIsHandled) {
    for (int i = 0; i < 200; ++i)
        message("hog", "state", "lost");
    boards.disconnected();
    handled.clear();
    message("hog", "state", "online");
    run();
    EXPECT_THAT(handled, ElementsAre("state online"));
}

TEST_F(BoardSharesTest, WhatWaitsOfABoard_KeepsItsOrder_AndHasABound) {
    for (int i = 0; i < 100; ++i)
        message("hog", "state", "");
    handled.clear();
    for (const char* topic : {"description", "state", "value", "description"})
        message("hog", topic, topic);
    run();
    EXPECT_THAT(handled, ElementsAre("state state", "value value", "description description"));
    handled.clear();
    for (int i = 0; i < 100; ++i)
        message("hog", "value/" + std::to_string(i), std::string(100 * 1024, 'x'));
    run();
    EXPECT_EQ(handled.size(), 5u);
    EXPECT_THAT(handled.back(), testing::StartsWith("value/99 "));
}

TEST(ProcessorTime, IsWhatTheThreadWorked_AndNotWhatItSlept) {
    const auto began = Shares::processor_time();
    std::this_thread::sleep_for(100ms);
    EXPECT_LT(Shares::processor_time() - began, 50ms);
    auto last = Shares::processor_time();
    for (const auto working = std::clock(); std::clock() - working < CLOCKS_PER_SEC / 50;) {
        const auto now = Shares::processor_time();
        ASSERT_GE(now, last);
        last = now;
    }
    EXPECT_GE(Shares::processor_time() - began, 10ms);
}

}  // namespace
}  // namespace asip::bus
