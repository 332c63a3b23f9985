// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;

constexpr int kIds = 40;
constexpr int kPayloads = 3;  // of each id

/// Sends commands under few ids again and again, to a board that sometimes is mute or away, and checks what
/// each is answered and how often it was executed.
class Repeats {
  public:
    explicit Repeats(unsigned seed) : random_(seed) { bench_.go_online(); }

    void step() {
        switch (below(20)) {
            case 0:
                bench_.board.mute = !bench_.board.mute;
                break;
            case 1:
                plugged_ ? bench_.unplug() : bench_.plug();
                plugged_ = !plugged_;
                break;
            case 2:
                bench_.pass(std::chrono::seconds(below(70)));
                break;
            default:
                bench_.pass(std::chrono::milliseconds(below(400)));
        }
        take_final_answers();
        command(below(kIds), below(kPayloads));
        check_executions();
    }
    unsigned repeated() const { return repeated_; }
    unsigned reused() const { return reused_; }

  private:
    struct Known {
        int payload;
        Time seen;
        std::string answer;  // empty: none yet
    };

    int below(int end) { return static_cast<int>(random_() % static_cast<unsigned>(end)); }
    static int position(int id, int payload) { return id * kPayloads + payload; }

    void command(int id, int payload) {
        const auto known = known_.find(id);
        const bool is_new = known == known_.end() || bench_.now >= known->second.seen + 60s;
        if (is_new) {
            known_[id] = {payload, bench_.now, {}};
            ++allowed_[position(id, payload)];
        }
        bench_.hear(
            "asip/uno1/servo/in",
            json{{"write", {0, position(id, payload)}}, {"id", std::to_string(id)}, {"reply_to", "answers"}}
                .dump());
        if (is_new) return take_final_answers();
        const auto answers = new_answers();
        if (known->second.payload != payload) {
            ++reused_;
            ASSERT_EQ(answers.size(), 1u);
            EXPECT_EQ(json::parse(answers[0])["reason"], "id-reused");
        } else if (known->second.answer.empty()) {
            EXPECT_EQ(answers.size(), 0u) << "it is answered when it ends";
        } else {
            ++repeated_;
            ASSERT_EQ(answers.size(), 1u);
            EXPECT_EQ(answers[0], known->second.answer);
        }
    }

    std::vector<std::string> new_answers() {
        auto answers = bench_.on("answers");
        bench_.published.clear();
        return answers;
    }

    void take_final_answers() {
        for (const std::string& text : new_answers()) {
            const auto answer = json::parse(text);
            const int id = std::stoi(answer["id"].get<std::string>());
            const auto known = known_.find(id);
            ASSERT_NE(known, known_.end()) << text;
            EXPECT_TRUE(known->second.answer.empty()) << "answered twice: " << text;
            known->second.answer = text;
            if (answer["status"] != "refused") continue;
            --allowed_[position(id, known->second.payload)];
            known_.erase(known);
        }
    }

    void check_executions() {
        for (const std::string& line : bench_.board.executed)
            if (line.starts_with("S,W,0,")) ++executed_[std::stoi(line.substr(6))];
        bench_.board.executed.clear();
        for (const auto& [place, times] : executed_)
            ASSERT_LE(times, allowed_[place]) << "executed again: S,W,0," << place;
    }

    std::mt19937 random_;
    BridgeBench bench_;
    bool plugged_ = true;
    std::map<int, Known> known_;
    std::map<int, int> allowed_, executed_;
    unsigned repeated_ = 0, reused_ = 0;
};

TEST(Idempotence, RandomHistories_RepeatedCommandsAreAnsweredAgainAndNeverExecutedAgain) {
    unsigned repeated = 0, reused = 0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(seed);
        Repeats repeats(seed);
        for (int i = 0; i < 600; ++i) {
            repeats.step();
            if (testing::Test::HasFatalFailure()) return;
        }
        repeated += repeats.repeated();
        reused += repeats.reused();
    }
    EXPECT_GT(repeated, 120u);
    EXPECT_GT(reused, 120u);
}

}  // namespace
}  // namespace asip::agent
