// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

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

/// It has answered "#,X", and stands still when it is asked what services it has.
class AskedForNames : public AskedForExtensions {
  protected:
    static constexpr const char* kNames = "@#,N,3,{I:ASIP core IO,S:Servos,D:Distance}";
    AskedForNames() {
        says("@#,X,5,{E:1,I:1,B:1,C:1,V:1}");
        for (int i = 0; i < 3; ++i)
            says_nothing();
    }
    void answers_the_rest() {
        for (const char* line : {"@#,S,6,{@,@,I,I,S,D}", "@I,M,6,{4:1,4:2,4:4,4:8,4:10,3:1}", "@I,m,1,{5:0}",
                                 "@I,p,6{6,6,1,1,7,7}", "@I,c,6,{1,1,1,5,1,3}", "@#,I,uno1"})
            says(line);
    }
    bool done() const { return interview_.progress() == Interview::Progress::kDone; }
};

TEST_F(AskedForNames, AnswersComeLate_AreTaken) {
    EXPECT_EQ(question(), "#,S");
    for (int i = 0; i < 3; ++i)
        says(kNames);
    answers_the_rest();
    ASSERT_TRUE(done());
    EXPECT_EQ(interview_.identity().services.size(), 3u);
    EXPECT_EQ(interview_.identity().port_map.positions().size(), 6u);
}

TEST_F(AskedForNames, AnswersAreLost_AreAskedForOnceMore) {
    answers_the_rest();
    ASSERT_FALSE(done());
    EXPECT_EQ(question(), "#,N");
    says(kNames);
    ASSERT_TRUE(done());
    EXPECT_EQ(interview_.identity().services.size(), 3u);
    EXPECT_EQ(std::count(asked_.begin(), asked_.end(), "#,S"), 1);
}

TEST_F(AskedForNames, BoardStandsStillForPinsToo_BothAreAskedForOnceMore) {
    says("@#,S,6,{@,@,I,I,S,D}");
    for (int i = 0; i < 3; ++i)
        says_nothing();
    EXPECT_EQ(question(), "I,m");
    says("@I,m,1,{5:0}");
    says("@I,p,6{6,6,1,1,7,7}");
    says("@I,c,6,{1,1,1,5,1,3}");
    says("@#,I,uno1");
    EXPECT_EQ(question(), "#,N");
    says(kNames);
    EXPECT_EQ(question(), "I,M");
    says("@I,M,6,{4:1,4:2,4:4,4:8,4:10,3:1}");
    EXPECT_TRUE(done());
    EXPECT_EQ(interview_.identity().port_map.positions().size(), 6u);
}

TEST_F(AskedForNames, AreNeverAnswered_EndsWithoutThem) {
    answers_the_rest();
    for (int i = 0; i < 3; ++i)
        says_nothing();
    EXPECT_TRUE(done());
    EXPECT_TRUE(interview_.identity().services.empty());
}

}  // namespace
}  // namespace asip::session
