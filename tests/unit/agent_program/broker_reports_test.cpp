// SPDX-License-Identifier: Apache-2.0
#include "agent/program/broker_reports.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::agent {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct BrokerReportsTest : testing::Test {
    /// What was said since the last call.
    std::vector<std::string> said() {
        std::vector<std::string> texts;
        for (const auto& line : log.take())
            texts.push_back(nlohmann::json::parse(line).value("text", line));
        return texts;
    }
    void connect() {
        reports.connected({}, counters);
        said();
    }
    void reject() {
        ++counters.rejected;
        reports.look_for_rejections(counters);
    }
    BoardLog log{{}, [] {}};
    mqtt::Counters counters;
    BrokerReports reports{log, [] { return BrokerReports::Agent{"uno1", "asip", "ann", "localhost:1883"}; }};
};

TEST_F(BrokerReportsTest, AnnouncementDenied_IsSaidOnceUntilOneIsTaken) {
    connect();
    reject();
    EXPECT_THAT(said(), ElementsAre(HasSubstr("denied announcing board uno1")));
    reject();
    connect();
    reject();
    reports.announcing_denied();
    EXPECT_THAT(said(), IsEmpty());
    EXPECT_TRUE(reports.announced());
    EXPECT_FALSE(reports.announced());
    connect();
    reports.announcing_denied();
    EXPECT_THAT(said(), ElementsAre(HasSubstr("User ann must be allowed")));
}

TEST_F(BrokerReportsTest, OtherMessagesRejected_AreSaidOnceForEachConnection) {
    for (int connection = 0; connection < 3; ++connection) {
        connect();
        reports.look_for_rejections(counters);
        EXPECT_THAT(said(), IsEmpty()) << "those of the connection before";
        EXPECT_TRUE(reports.announced());
        reject();
        EXPECT_THAT(said(), ElementsAre(HasSubstr("refuses some")));
        reject();
        EXPECT_THAT(said(), IsEmpty());
    }
}

TEST_F(BrokerReportsTest, MessageTooLarge_IsNoQuestionOfAccess) {
    connect();
    ++counters.too_large;
    reports.denied("a message of 900 bytes, where the broker takes packets up to 300 bytes");
    reports.look_for_rejections(counters);
    EXPECT_THAT(said(), ElementsAre(HasSubstr("larger than the broker takes")));
}

TEST_F(BrokerReportsTest, Drops_AreSaidAgainWhereTheyGoOn) {
    reports.look_for_drops(counters);
    EXPECT_THAT(said(), IsEmpty());
    for (int i = 0; i < 2; ++i) {
        counters.dropped_context += 7;
        reports.look_for_drops(counters);
        EXPECT_THAT(said(), ElementsAre(HasSubstr("oldest values dropped")));
        reports.look_for_drops(counters);
        EXPECT_THAT(said(), IsEmpty());
    }
}

TEST_F(BrokerReportsTest, Drops_NameEveryReasonThatThereCanBe) {
    reports.look_for_drops(counters);
    counters.dropped_context += 7;
    counters.refused += 2;
    reports.look_for_drops(counters);
    EXPECT_THAT(said(), ::testing::Each(HasSubstr("it is slow, or away")));
}

TEST_F(BrokerReportsTest, MissingCredentials_AreSaidOnce) {
    reports.credentials_missing("uno1", "/etc/asip");
    reports.credentials_missing("uno1", "/etc/asip");
    EXPECT_THAT(said(), ElementsAre(HasSubstr("secure add board uno1 --here")));
}

}  // namespace
}  // namespace asip::agent
