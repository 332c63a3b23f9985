// SPDX-License-Identifier: Apache-2.0
// Random histories: connections break and come back, answers come late, twice, for others or never, the
// broker denies and has no room, agents start anew. What must hold after each of them is checked.
#include <gtest/gtest.h>

#include <random>

#include "simulated_program.hpp"

namespace asip::caller {
namespace {

class History : public SimulatedProgram {
  public:
    explicit History(std::uint32_t seed) : random_(seed) {
        caller->watch("uno1");
        connect();
    }

    void run(int steps) {
        for (int i = 0; i < steps; ++i) {
            step();
            pass(std::chrono::milliseconds(pick(900)));
        }
        pass(2min);
        for (const auto& each : commands_)
            EXPECT_EQ(each->told, each->handle_ended ? each->told : 1);
    }

  private:
    struct Asked {
        Time until{};
        int told = 0;
        bool ok_was_said = false;
        bool handle_ended = false;
        Caller::Call call;
        mqtt::Message message;
        bool is_sent = false;
    };

    int pick(int below) { return std::uniform_int_distribution<int>(0, below - 1)(random_); }

    void ask() {
        auto& asked = *commands_.emplace_back(std::make_unique<Asked>());
        const auto deadline = std::chrono::milliseconds(50 + pick(6000));
        asked.until = now + deadline + Caller::kAnswerTime;
        const auto before = sent.size();
        asked.call = caller->command(
            {.topic = "asip/uno" + std::to_string(1 + pick(2)) + "/servo/in",
             .payload = "W,0,90",
             .deadline = deadline},
            [this, &asked](const bus::Reply& reply) { told(asked, reply); }, now);
        EXPECT_EQ(asked.told, 0);
        asked.is_sent = sent.size() > before;
        if (asked.is_sent) asked.message = sent.back();
    }
    void told(Asked& asked, const bus::Reply& reply) {
        EXPECT_EQ(++asked.told, 1);
        EXPECT_LE(now, asked.until);
        EXPECT_FALSE(asked.handle_ended);
        EXPECT_EQ(reply.succeeded(), asked.ok_was_said);
        // "Refused" is only what no agent can have got.
        EXPECT_TRUE(reply.reason != bus::kRefusedQueueFull || !asked.is_sent);
        EXPECT_EQ(bus::sentence_of(reply).empty(), reply.succeeded());
    }
    void answer_one() {
        if (commands_.empty()) return;
        auto& asked = *commands_[static_cast<std::size_t>(pick(static_cast<int>(commands_.size())))];
        if (!asked.is_sent || !connected_) return;
        asked.ok_was_said = asked.ok_was_said || asked.told == 0;
        for (int times = 1 + pick(2); times > 0; --times)
            answer(asked.message, {{"status", "ok"}},
                   std::to_string(pick(3)) + "aa-" + std::to_string(pick(9999)));
    }
    void step() {
        switch (pick(10)) {
            case 0:
                if (connected_) lose("lost", static_cast<unsigned>(pick(3)));
                connected_ = false;
                break;
            case 1:
                if (!connected_) connect();
                connected_ = true;
                break;
            case 2:
                room = !room;
                break;
            case 3:
                caller->denied("asip/uno1/servo/in", "Not authorized");
                break;
            case 4:
                if (!commands_.empty() && pick(3) == 0) {
                    commands_.back()->call.reset();
                    commands_.back()->handle_ended = true;
                }
                break;
            case 5:
                receive("asip/reply/ann/uno1/me", "no JSON");
                receive("asip/servicebus/uno1/$state", pick(2) == 0 ? "online" : "lost", pick(2) == 0);
                break;
            case 6:
            case 7:
                answer_one();
                break;
            default:
                ask();
        }
    }

    std::mt19937 random_;
    std::vector<std::unique_ptr<Asked>> commands_;
    bool connected_ = true;
};

TEST(CallerHistories, WhateverHappens_EachCommandEndsOnceInTime) {
    for (std::uint32_t seed = 1; seed <= 300; ++seed) {
        SCOPED_TRACE(seed);
        History(seed).run(100);
        if (testing::Test::HasFailure()) break;
    }
}

}  // namespace
}  // namespace asip::caller
