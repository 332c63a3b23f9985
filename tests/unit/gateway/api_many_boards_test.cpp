// SPDX-License-Identifier: Apache-2.0
// Stops and resumes of many boards, asked again and again.
#include <algorithm>

#include "api_bench.hpp"

namespace asip::gateway {
namespace {

using testing::HasSubstr;
using testing::internal::CaptureStderr;
using testing::internal::GetCapturedStderr;

constexpr std::size_t kBoards = api::ManyBoards::kFew + 4;

class ManyBoardsApi : public ApiTest {
  protected:
    ManyBoardsApi() {
        for (std::size_t i = 0; i < kBoards; ++i)
            announce(name(i));
        published_.clear();
    }
    static std::string name(std::size_t number) { return "board" + std::to_string(10 + number); }
    static std::string all_names() {
        nlohmann::json names;
        for (std::size_t i = 0; i < kBoards; ++i)
            names["boards"].push_back(name(i));
        return names.dump();
    }
    /// What was sent since it was asked for last, answered, but for the first `silent` boards.
    std::vector<mqtt::Message> answer_all(std::size_t silent = 0, const std::string& status = "ok") {
        const auto sent = std::exchange(published_, {});
        for (std::size_t i = silent; i < sent.size(); ++i) {
            gateway_->message(mqtt::Message{.topic = sent[i].response_topic,
                                            .payload = R"({"status":")" + status + R"("})",
                                            .correlation = sent[i].correlation});
        }
        return sent;
    }
    std::vector<std::shared_ptr<Captured>> ask_often(const std::string& target, std::size_t times) {
        std::vector<std::shared_ptr<Captured>> asked;
        for (std::size_t i = 0; i < times; ++i)
            asked.push_back(ask("POST", target));
        return asked;
    }
    static bool all_have(const std::vector<std::shared_ptr<Captured>>& asked, int status) {
        return std::all_of(asked.begin(), asked.end(), [&](const auto& each) {
            return each->status() == status && each->body()["boards"].size() == kBoards;
        });
    }
};

TEST_F(ManyBoardsApi, StopsInALoop_OneIsUnderWay_AndThoseBehindItAreOneMore) {
    const auto first = ask("POST", "/api/stop");
    EXPECT_EQ(published_.size(), kBoards);
    auto asked = ask_often("/api/stop?once=true", 30);
    asked.push_back(ask("POST", "/api/stop", all_names()));
    EXPECT_EQ(published_.size(), kBoards) << "no more";
    answer_all();
    EXPECT_EQ(first->status(), 200);
    EXPECT_EQ(asked.front()->status(), 0) << "a stop that was asked for later is sent later";
    pass(100ms);
    const auto sent = answer_all();
    ASSERT_EQ(sent.size(), kBoards);
    EXPECT_THAT(sent.front().payload, HasSubstr("latch")) << "one of them is to hold";
    EXPECT_TRUE(all_have(asked, 200));
    pass(100ms);
    EXPECT_TRUE(published_.empty());
    ask("POST", "/api/stop");
    EXPECT_EQ(published_.size(), kBoards);
}

TEST_F(ManyBoardsApi, BoardDoesNotAnswer_TheNextStopWaitsForItOnlySoLong) {
    ask("POST", "/api/stop");
    answer_all(1);
    ask("POST", "/api/stop");
    pass(api::ManyBoards::kLongest - 100ms);
    EXPECT_TRUE(published_.empty());
    pass(100ms);
    EXPECT_EQ(published_.size(), kBoards);
}

TEST_F(ManyBoardsApi, StopOfFewBoardsOrOfAnother_WaitsForNone) {
    ask("POST", "/api/stop");
    published_.clear();
    ask("POST", "/api/boards/board10/stop");
    ask("POST", "/api/stop", R"({"boards":["board11","board12"]})");
    EXPECT_EQ(published_.size(), 3u);
}

TEST_F(ManyBoardsApi, StopBehindAResume_IsSentAtOnce_AndAResumeThatWaitsIsRefused) {
    ask("POST", "/api/resume", all_names());
    EXPECT_EQ(published_.size(), kBoards);
    published_.clear();
    const auto waiting = ask("POST", "/api/resume", all_names());
    EXPECT_TRUE(published_.empty());
    ask("POST", "/api/stop");
    EXPECT_EQ(waiting->status(), 409);
    EXPECT_EQ(published_.size(), kBoards);
    published_.clear();
    const auto stop = ask("POST", "/api/stop");
    const auto resume = ask("POST", "/api/resume", all_names());
    pass(api::ManyBoards::kLongest);
    EXPECT_THAT(published_.front().topic, HasSubstr("$stop"));
    answer_all();
    EXPECT_EQ(stop->status(), 200);
    pass(100ms);
    EXPECT_THAT(published_.front().payload, HasSubstr("resume")) << "behind the stop that came before it";
    answer_all();
    EXPECT_EQ(resume->status(), 200);
}

TEST_F(ManyBoardsApi, StopOfAll_IsOneLineOfTheLog) {
    program::log::configure(program::log::Level::kInfo, program::log::Format::kText);
    CaptureStderr();
    ask("POST", "/api/stop");
    answer_all(1);
    pass(10s);
    const auto logged = GetCapturedStderr();
    program::log::configure(program::log::Level::kOff, program::log::Format::kText);
    EXPECT_EQ(std::count(logged.begin(), logged.end(), '\n'), 2) << "the request, and its end: " << logged;
    EXPECT_THAT(logged, HasSubstr("stop of many boards"));
    EXPECT_THAT(logged, HasSubstr("boards=20 ok=19"));
    EXPECT_THAT(logged, HasSubstr("board10 no-answer"));
}

}  // namespace
}  // namespace asip::gateway
