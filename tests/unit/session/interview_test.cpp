// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "asip/protocol/extensions.hpp"
#include "asip/session/interview.hpp"

namespace asip::session {
namespace {

using namespace std::chrono_literals;

constexpr Duration kAnswerTimeout = 1500ms;

/// An interview whose board has said that it is one.
class AskedForExtensions : public testing::Test {
  protected:
    AskedForExtensions() { says("@#,?,0,4,ATmega328P,6,Script"); }

    void says(std::string_view line) {
        const auto message = protocol::parse_line(line);
        if (const auto* const event = std::get_if<protocol::Event>(&message))
            interview_.on_event(*event, now_, asked_);
        if (const auto* const error = std::get_if<protocol::ErrorReply>(&message))
            interview_.on_error(*error, now_, asked_);
    }
    void says_nothing() {
        now_ += kAnswerTimeout;
        interview_.on_deadline(now_, kAnswerTimeout, asked_);
    }
    const std::string& question() const { return asked_.back(); }
    bool has(char extension) { return interview_.identity().extensions.has(extension); }

    Time now_{};
    std::vector<std::string> asked_;
    Interview interview_{"", false, now_, asked_};
};

TEST_F(AskedForExtensions, Answered_IsBelievedAtOnce) {
    EXPECT_EQ(question(), "#,X");
    says("@#,X,5,{E:1,I:1,B:1,C:1,V:1}");
    EXPECT_EQ(question(), "#,N");
    EXPECT_TRUE(has(protocol::kVerifiedFence));
}

TEST_F(AskedForExtensions, ErrorsAboutWhatWasSentBefore_CostNoExtensions) {
    for (int i = 0; i < 20; ++i)
        says("~#,C,11{BAD_ARGUMENT}");
    EXPECT_LE(asked_.size(), 5u) << "not one question an error";
    says("@#,X,5,{E:1,I:1,B:1,C:1,V:1}");
    EXPECT_EQ(question(), "#,N");
    EXPECT_TRUE(has(protocol::kVerifiedFence));
}

TEST_F(AskedForExtensions, ADamagedQuestionIsRefused_IsAskedAgain) {
    says("~#,X,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(question(), "#,X");
    says("@#,X,5,{E:1,I:1,B:1,C:1,V:1}");
    EXPECT_TRUE(has(protocol::kVerifiedFence));
}

TEST_F(AskedForExtensions, RefusedTwice_HasNone) {
    says("~#,X,2{UNKNOWN_REQUEST}");
    says("~#,X,2{UNKNOWN_REQUEST}");
    EXPECT_EQ(question(), "#,N");
    EXPECT_TRUE(interview_.identity().extensions.empty());
}

TEST_F(AskedForExtensions, AnswerIsChanged_IsAskedAgain) {
    says("@#,X,5,{E:1,I:1,B:1,C:1,U:1}");
    EXPECT_EQ(question(), "#,X");
    says("@#,X,5,{E:1,I:1,B:1,C:1,V:1}");
    EXPECT_TRUE(has(protocol::kVerifiedFence));
}

TEST_F(AskedForExtensions, SomeAreMissingTwice_AreNotThere) {
    says("@#,X,4,{E:1,I:1,B:1,C:1}");
    says("@#,X,4,{E:1,I:1,B:1,C:1}");
    EXPECT_EQ(question(), "#,N");
    EXPECT_TRUE(has(protocol::kEcho));
    EXPECT_FALSE(has(protocol::kVerifiedFence));
}

TEST_F(AskedForExtensions, BoardStoodStill_IsAskedFromTheStart) {
    for (int i = 0; i < 3; ++i)
        says_nothing();
    EXPECT_EQ(question(), "#,?");
    says("@#,?,0,4,ATmega328P,6,Script");
    says("@#,X,5,{E:1,I:1,B:1,C:1,V:1}");
    EXPECT_TRUE(has(protocol::kVerifiedFence));
}

TEST_F(AskedForExtensions, BoardNeverAnswersThat_HasNone) {
    for (int i = 0; i < 3; ++i)
        says_nothing();
    says("@#,?,0,4,ATmega328P,6,Script");
    for (int i = 0; i < 3; ++i)
        says_nothing();
    EXPECT_EQ(question(), "#,N");
    EXPECT_TRUE(interview_.identity().extensions.empty());
}

}  // namespace
}  // namespace asip::session
