// SPDX-License-Identifier: Apache-2.0
#include "bench/load/board.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace asip::load {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

struct BoardTest : testing::Test {
    BoardTest() {
        board.on_connected(now, out);
        board.on_subscribed(now, out);
        now += 2s;
        board.tick(now, out);
    }

    std::vector<std::string> on(const std::string& topic) const {
        std::vector<std::string> payloads;
        for (const auto& one : out.publish)
            if (one.message.topic == topic) payloads.push_back(one.message.payload);
        return payloads;
    }
    json command(const std::string& topic, const std::string& payload, bool retained = false) {
        mqtt::Message message{.topic = topic,
                              .payload = payload,
                              .retain = retained,
                              .response_topic = "answers",
                              .correlation = "7"};
        out = {};
        EXPECT_TRUE(board.on_message(message, now, out));
        const auto answers = on("answers");
        return answers.size() == 1 ? json::parse(answers.front()) : json();
    }

    bus::Topics topics;
    BoardKind kind = *make_board_kind({"io", "distance", "servo", "bump", "encoders"});
    Time now = Time{} + 1h;
    member::Announcements out;
    SimulatedBoard board{
        topics, kind, {.board = "load-7"}, kind.describe(7, {"0.1.0", "pi", "client-7"}), [] {
            return std::uint64_t{1};
        }};
};

TEST_F(BoardTest, Joined_IsAnnouncedInBothLayersWithinAKilobyte) {
    EXPECT_TRUE(board.announced());
    EXPECT_THAT(on("asip/servicebus"), testing::ElementsAre("load-7"));
    EXPECT_THAT(on("asip/servicebus/load-7"),
                testing::ElementsAre("io", "distance", "servo", "bump", "encoders"));
    EXPECT_THAT(on("asip/servicebus/load-7/$state"), testing::ElementsAre("online"));
    const auto descriptions = on("asip/servicebus/load-7/$description");
    ASSERT_EQ(descriptions.size(), 1u);
    EXPECT_TRUE(model::parse_description(descriptions.front()));
    EXPECT_LE(descriptions.front().size(), 1024u);
}

TEST_F(BoardTest, LeaseRunning_IsRenewedByOneMessage) {
    out = {};
    for (const Time end = now + 60s; now < end; now += 100ms)
        board.tick(now, out);
    EXPECT_GE(out.publish.size(), 2u);
    EXPECT_EQ(out.publish.size(), on("asip/servicebus/load-7/$description").size());
}

TEST_F(BoardTest, Command_IsAnsweredAsOneThatNothingExecuted) {
    const auto answer = command("asip/load-7/servo/in", R"({"write":[0,90]})");
    EXPECT_EQ(answer.at("status"), "ok");
    EXPECT_EQ(answer.at("proof"), "simulated");
    EXPECT_EQ(command("asip/load-7/in", "#,?").at("status"), "ok");
    EXPECT_EQ(command("asip/load-7/$stop", "").at("status"), "ok");
}

TEST_F(BoardTest, Labels_AreTakenAndAnnounced) {
    EXPECT_EQ(command("asip/load-7/in", R"({"labels":{"room":"lab"}})").at("status"), "ok");
    EXPECT_EQ(command("asip/load-7/in", R"({"labels":{"no key":"x"}})").at("status"), "refused");
    EXPECT_EQ(command("asip/load-7/in", R"({"labels":{"shelf":"2"}})").at("proof"), "kept");
    out = {};
    now += 2s;
    board.tick(now, out);
    const auto descriptions = on("asip/servicebus/load-7/$description");
    ASSERT_EQ(descriptions.size(), 1u);
    EXPECT_EQ(json::parse(descriptions.front()).at("labels"), json::parse(R"({"room":"lab","shelf":"2"})"));
}

TEST_F(BoardTest, WrongCommand_IsRefusedInWordsAndTheNextOneWorks) {
    const auto unknown = command("asip/load-7/servo/in", R"({"wirte":[0,90]})");
    EXPECT_EQ(unknown.at("status"), "refused");
    EXPECT_THAT(unknown.at("error"), HasSubstr("did you mean 'write'"));
    EXPECT_THAT(command("asip/load-7/motor/in", "{}").at("error"), HasSubstr("no service \"motor\""));
    EXPECT_EQ(command("asip/load-7/servo/in", R"({"write":)").at("status"), "refused");
    EXPECT_EQ(command("asip/load-7/servo/in", R"({"write":[0,90]})", true).at("reason"), "retained");
    EXPECT_EQ(command("asip/load-7/servo/in", R"({"write":[0,90]})").at("status"), "ok");
}

TEST_F(BoardTest, Reports_AreOneValueOfEachServiceThatHasEvents) {
    out = {};
    board.report(out);
    EXPECT_EQ(out.publish.size(), 4u) << "servos report nothing";
    EXPECT_THAT(on("asip/load-7/distance/out"), testing::ElementsAre(R"({"distance":[42,118]})"));
    board.on_disconnected();
    out = {};
    board.report(out);
    EXPECT_TRUE(out.publish.empty());
}

TEST(BoardKind, UnknownOrRepeatedModel_IsRefusedInWords) {
    EXPECT_THAT(make_board_kind({"distnace"}).error(), HasSubstr("did you mean \"distance\""));
    EXPECT_THAT(make_board_kind({"io", "io"}).error(), HasSubstr("given twice"));
}

}  // namespace
}  // namespace asip::load
