// SPDX-License-Identifier: Apache-2.0
#include "asip/program/broker_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/program/log.hpp"

namespace asip::program {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class BrokerLogTest : public testing::Test {
  protected:
    BrokerLogTest() { log::configure(log::Level::kInfo, log::Format::kText); }

    std::string failed(const mqtt::ConnectionFailure& failure, bool ends = false) {
        testing::internal::CaptureStderr();
        EXPECT_EQ(log_.connect_failed(failure, [this](Duration wait) { waits_.push_back(wait); }), ends);
        return testing::internal::GetCapturedStderr();
    }

    mqtt::ConnectionFailure failure_{mqtt::ConnectionFailure::Kind::kUnreachable, {}, 0, "cannot reach it"};
    BrokerLog log_;
    std::vector<Duration> waits_;
};

TEST_F(BrokerLogTest, SameFailureAgain_IsLoggedOnceUntilTheOutageIsOver) {
    EXPECT_THAT(failed(failure_), HasSubstr("warning no connection; trying again"));
    EXPECT_THAT(failed(failure_), IsEmpty());
    testing::internal::CaptureStderr();
    log_.connected({});
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("connected"));
    EXPECT_THAT(failed(failure_), HasSubstr("cannot reach it"));
}

TEST_F(BrokerLogTest, OtherFailureOfTheSameOutage_IsLogged) {
    failed(failure_);
    failure_.kind = mqtt::ConnectionFailure::Kind::kNoAnswer;
    EXPECT_THAT(failed(failure_), HasSubstr("no connection"));
}

TEST_F(BrokerLogTest, HopelessFailure_IsAnErrorThatEndsTheProgram) {
    failure_.hopeless = true;
    EXPECT_THAT(failed(failure_, true), HasSubstr("error   no broker accepts the connection"));
    EXPECT_THAT(waits_, IsEmpty());
}

TEST_F(BrokerLogTest, HopelessFailureOfAService_IsAskedAgainHalfAMinuteToFiveMinutesApart) {
    setenv("NOTIFY_SOCKET", "/nonexistent/socket", 1);
    failure_.hopeless = true;
    for (int i = 0; i < 20; ++i)
        EXPECT_THAT(failed(failure_, false), HasSubstr("asking again"));
    unsetenv("NOTIFY_SOCKET");
    ASSERT_EQ(waits_.size(), 20u);
    for (const auto wait : waits_) {
        EXPECT_GE(wait, std::chrono::seconds(30));
        EXPECT_LE(wait, std::chrono::minutes(5));
    }
    EXPECT_GT(waits_.back(), std::chrono::minutes(2));
}

}  // namespace
}  // namespace asip::program
