// SPDX-License-Identifier: Apache-2.0
#include "gateway/auth/lessons.hpp"

#include <gmock/gmock.h>

#include <set>

#include "clock.hpp"

namespace asip::gateway {
namespace {

using Outcome = Lessons::Joined::Outcome;
using testing::HasSubstr;

class LessonsTest : public testing::Test {
  protected:
    LessonsTest() {
        teacher_.role = Role::kOperator;
        teacher_.name = "miss";
        teacher_.token_hash = hash_of("token");
    }
    const Lesson& open(const std::vector<std::string>& boards, Duration time = 45min,
                       std::chrono::milliseconds when = 0ms) {
        const auto id = lessons_.open(teacher_, boards, time, at(when));
        EXPECT_TRUE(id) << id.error();
        return *lessons_.find(*id);
    }
    Lessons::Joined join(const std::string& code, const std::string& address = "10.0.0.7",
                         std::chrono::milliseconds when = 0ms, const std::string& cookie = {}) {
        return lessons_.join(
            code, address, cookie, [this](const std::string& board) { return !gone_.contains(board); },
            at(when));
    }

    Rights teacher_;
    std::set<std::string> gone_;
    Lessons lessons_{[n = 0](std::size_t bytes) mutable {
        return "secret-" + std::to_string(bytes) + "-" + std::to_string(++n);
    }};
};

TEST_F(LessonsTest, Code_HasSixLettersThatLookLikeNoOther) {
    std::set<std::string> codes;
    for (int i = 0; i < 16; ++i) {
        const auto code = open({"uno" + std::to_string(i)}).code;
        EXPECT_EQ(code.size(), 6u);
        EXPECT_EQ(code.find_first_of("0O1IL2Z5S6G8BUAE"), std::string::npos) << code;
        codes.insert(code);
    }
    EXPECT_EQ(codes.size(), 16u);
}

TEST_F(LessonsTest, Pupils_GetOneBoardEach_InTheirOrder) {
    const auto code = open({"student-1", "student-2"}).code;
    const auto one = join(code);
    ASSERT_EQ(one.outcome, Outcome::kJoined);
    EXPECT_EQ(one.rights.role, Role::kOperator);
    EXPECT_EQ(one.rights.boards, std::vector<std::string>{"student-1"});
    EXPECT_THAT(one.rights.name, testing::StartsWith("student-1@"));
    EXPECT_TRUE(one.rights.may_command());
    EXPECT_TRUE(one.rights.may_stop());
    EXPECT_FALSE(one.rights.may_resume() || one.rights.may_label() || one.rights.may_arrange() ||
                 one.rights.may_send_raw() || one.rights.may_forget());
    EXPECT_EQ(join(code).rights.boards, std::vector<std::string>{"student-2"});
    EXPECT_EQ(join(code).outcome, Outcome::kNoBoardFree);
    EXPECT_EQ(lessons_.rights_of(one.cookie, at(0ms)), one.rights);
}

TEST_F(LessonsTest, CodeIsTypedAsPeopleDo_CaseBlanksAndDashesDoNotMatter) {
    const auto code = open({"uno1"}).code;
    std::string typed = " " + code.substr(0, 3) + "-" + code.substr(3) + " ";
    for (auto& c : typed)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    EXPECT_EQ(join(typed).outcome, Outcome::kJoined);
}

TEST_F(LessonsTest, PupilsWhoLend_HaveAPlaceEach_AndTheSameNamesServeTheNextLesson) {
    open({"lent-student-2"});
    const auto lesson = open({});
    const auto one = join(lesson.code);
    ASSERT_EQ(one.outcome, Outcome::kJoined);
    EXPECT_EQ(one.rights.boards, std::vector<std::string>{"lent-student-1"});
    EXPECT_EQ(one.rights.place, "student-1");
    EXPECT_TRUE(one.rights.may_lend());
    EXPECT_FALSE(one.rights.may_label() || one.rights.may_resume());
    const auto two = join(lesson.code);
    EXPECT_EQ(two.rights.place, "student-3") << "another lesson has lent-student-2";
    EXPECT_THAT(two.rights.name, testing::StartsWith("student-3@"));
    EXPECT_FALSE(join(lessons_.all().front().code).rights.may_lend()) << "of a lesson that lends";
    lessons_.leave(one.cookie);
    EXPECT_EQ(join(lesson.code).rights.place, "student-1") << "the place of one who left";
    for (std::size_t i = 2; i < Lessons::kMaxBoards; ++i)
        EXPECT_EQ(join(lesson.code).outcome, Outcome::kJoined);
    EXPECT_EQ(join(lesson.code).outcome, Outcome::kNoBoardFree);
    lessons_.end(lesson.id);
    EXPECT_EQ(lessons_.rights_of(two.cookie, at(0ms)), std::nullopt);
    EXPECT_EQ(join(open({}).code).rights.place, "student-1");
}

TEST_F(LessonsTest, SameBrowserAgain_HasTheSameBoard) {
    const auto code = open({"uno1", "uno2"}).code;
    const auto first = join(code);
    const auto again = join(code, "10.0.0.7", 1min, first.cookie);
    EXPECT_EQ(again.outcome, Outcome::kJoined);
    EXPECT_TRUE(again.again);
    EXPECT_EQ(again.cookie, first.cookie);
    EXPECT_EQ(again.rights, first.rights);
    EXPECT_EQ(join(code).rights.boards, std::vector<std::string>{"uno2"}) << "still free";
}

TEST_F(LessonsTest, BoardThatIsNotThere_IsLentOnceItIs) {
    gone_ = {"uno1"};
    const auto code = open({"uno1", "uno2"}).code;
    EXPECT_EQ(join(code).rights.boards, std::vector<std::string>{"uno2"});
    EXPECT_EQ(join(code).outcome, Outcome::kNoBoardFree);
    gone_.clear();
    EXPECT_EQ(join(code).rights.boards, std::vector<std::string>{"uno1"});
}

TEST_F(LessonsTest, TwoLessons_ShareNoBoardAndNoName_AndABrowserIsInOne) {
    const auto code = open({"uno1"}).code;
    const auto refused = lessons_.open(teacher_, {"uno2", "uno1"}, 45min, at(0ms));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error(), HasSubstr("uno1 belongs to a lesson"));
    const auto other = open({"uno2"}).code;
    EXPECT_NE(code, other);
    const auto one = join(code);
    const auto two = join(other, "10.0.0.7", 0ms, one.cookie);
    EXPECT_EQ(two.rights.boards, std::vector<std::string>{"uno2"});
    EXPECT_NE(one.rights.name, two.rights.name) << "limits and commands are of a name";
    EXPECT_FALSE(lessons_.rights_of(one.cookie, at(0ms))) << "it left the first one";
    EXPECT_EQ(join(code).outcome, Outcome::kJoined) << "whose board is free";
    EXPECT_EQ(join(code, "10.0.0.7", 0ms, two.cookie).outcome, Outcome::kNoBoardFree);
    EXPECT_TRUE(lessons_.rights_of(two.cookie, at(0ms))) << "in vain: it keeps what it has";
}

TEST_F(LessonsTest, End_ComesByTimeByTheTeacherAndWithTheTeachersRights) {
    const auto everybody = [](const Rights&) { return true; };
    const auto code = open({"uno1"}, 10min).code;
    const auto pupil = join(code);
    EXPECT_TRUE(lessons_.rights_of(pupil.cookie, at(10min - 1ms)));
    EXPECT_FALSE(lessons_.rights_of(pupil.cookie, at(10min)));
    EXPECT_EQ(join(code, "10.0.0.7", 10min).outcome, Outcome::kNoSuchCode);
    lessons_.expire(at(10min), everybody);
    EXPECT_TRUE(lessons_.all().empty());

    const auto id = open({"uno1"}, 10min, 20min).id;
    const auto next = join(lessons_.find(id)->code, "10.0.0.8", 20min);
    EXPECT_TRUE(lessons_.end(id));
    EXPECT_FALSE(lessons_.end(id));
    EXPECT_FALSE(lessons_.rights_of(next.cookie, at(20min)));

    open({"uno1"}, 10min, 21min);
    auto clock_was_set = at(22min);
    clock_was_set.wall += 10min;  // its pupils have no rights any more
    lessons_.expire(clock_was_set, everybody);
    EXPECT_TRUE(lessons_.all().empty());

    open({"uno1"}, 10min, 30min);
    lessons_.expire(at(31min), [&](const Rights& pupil_rights) {
        EXPECT_EQ(pupil_rights.maker, "miss");
        EXPECT_EQ(pupil_rights.maker_mark, teacher_.mark());
        return false;
    });
    EXPECT_TRUE(lessons_.all().empty());
}

TEST_F(LessonsTest, BoardTakenOver_IsFreeOrStaysWithTheTeacher) {
    const auto& lesson = open({"uno1", "uno2"});
    const auto one = join(lesson.code);
    EXPECT_TRUE(lessons_.take_over(lesson.id, "uno1", true));
    EXPECT_FALSE(lessons_.rights_of(one.cookie, at(0ms)));
    EXPECT_EQ(join(lesson.code).rights.boards, std::vector<std::string>{"uno2"});
    EXPECT_EQ(join(lesson.code).outcome, Outcome::kNoBoardFree);
    EXPECT_TRUE(lessons_.take_over(lesson.id, "uno1", false));
    const auto two = join(lesson.code);
    EXPECT_EQ(two.rights.boards, std::vector<std::string>{"uno1"});
    EXPECT_NE(two.cookie, one.cookie);
    EXPECT_FALSE(lessons_.rights_of(one.cookie, at(0ms))) << "who had it before has it no more";
    EXPECT_FALSE(lessons_.take_over(lesson.id, "uno3", false));
    EXPECT_FALSE(lessons_.take_over("none", "uno1", false));
}

TEST_F(LessonsTest, PupilWhoLeaves_GivesTheBoardBack) {
    const auto code = open({"uno1"}).code;
    const auto one = join(code);
    lessons_.leave("lesson.other");
    lessons_.leave("");
    EXPECT_EQ(join(code).outcome, Outcome::kNoBoardFree);
    lessons_.leave(one.cookie);
    EXPECT_EQ(join(code).outcome, Outcome::kJoined);
}

TEST_F(LessonsTest, FiveWrongCodes_ThenTheAddressWaitsAMinute_AndNoOther) {
    const auto code = open({"uno1", "uno2"}).code;
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ(join("CDFHJK", "10.0.0.7", i * 1s).outcome, Outcome::kNoSuchCode);
    const auto refused = join(code, "10.0.0.7", 10s);
    EXPECT_EQ(refused.outcome, Outcome::kTooManyTries) << "the right one, too";
    EXPECT_EQ(refused.wait, 50s);
    EXPECT_EQ(join(code, "10.0.0.8", 10s).outcome, Outcome::kJoined);
    EXPECT_EQ(join("CDFHJK", "10.0.0.7", 60s).outcome, Outcome::kNoSuchCode) << "the first is forgotten";
    EXPECT_EQ(join(code, "10.0.0.7", 60s).outcome, Outcome::kTooManyTries);
    EXPECT_EQ(join(code, "10.0.0.7", 61s).outcome, Outcome::kJoined);
}

// 20^6 codes: 60 tries a minute find one of them in a lesson of an hour once in 17,000 times.
TEST_F(LessonsTest, GuessesOfManyAddresses_HaveOneBoundTogether) {
    const auto code = open({"uno1"}).code;
    std::size_t tried = 0;
    for (int i = 0; i < 1000; ++i)
        tried += join("CDFHJK", "10.0.1." + std::to_string(i), 1ms * i).outcome == Outcome::kNoSuchCode;
    EXPECT_EQ(tried, Lessons::kAllTries);
    EXPECT_EQ(join(code, "10.0.0.7", 30s).outcome, Outcome::kTooManyTries);
    EXPECT_EQ(join(code, "10.0.0.7", 61s).outcome, Outcome::kJoined);
}

TEST_F(LessonsTest, CodeThatIsNone_IsAWrongTry) {
    open({"uno1"});
    for (const std::string& code : {std::string(), std::string("C"), std::string(10'000, 'C'),
                                    std::string("\0\0\0\0\0\0", 6), std::string("\xff\xfe\xfd\xfc\xfb\xfa")})
        EXPECT_EQ(join(code).outcome, Outcome::kNoSuchCode);
    EXPECT_EQ(join("C").outcome, Outcome::kTooManyTries);
}

TEST_F(LessonsTest, Lessons_HaveABound) {
    for (std::size_t i = 0; i < Lessons::kMaxLessons; ++i)
        open({"uno" + std::to_string(i)});
    EXPECT_FALSE(lessons_.open(teacher_, {"one-more"}, 45min, at(0ms)));
    lessons_.end(lessons_.all().front().id);
    EXPECT_TRUE(lessons_.open(teacher_, {"one-more"}, 45min, at(0ms)));
}

}  // namespace
}  // namespace asip::gateway
