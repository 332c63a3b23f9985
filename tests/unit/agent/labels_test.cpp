// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kRequests = "asip/uno1/in";
const std::string kDescribed = "asip/servicebus/uno1/$description";

struct LabelledBridge : OnlineBridge {
    json ask(json request, const std::string& id = "1") {
        return bench.ask(kRequests, std::move(request), id);
    }
    json described() {
        bench.published.clear();
        bench.pass(1500ms);
        const auto all = bench.on(kDescribed);
        return all.empty() ? json() : json::parse(all.back());
    }
};

TEST_F(LabelledBridge, Change_IsWrittenThenAnsweredThenAnnounced) {
    EXPECT_TRUE(
        ask({{"labels", {{"room", "lab"}}}, {"names", {{"services", {{"servo", "left arm"}}}}}}).is_null())
        << "not before it is on the disk";
    ASSERT_EQ(bench.to_keep.size(), 1u);
    EXPECT_EQ(bench.to_keep[0].labels.at("room"), "lab");
    bench.labels_kept();
    const auto answer = json::parse(bench.on("answers").at(0));
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["proof"], "kept");
    EXPECT_EQ(answer["answer"],
              json::parse(R"({"labels":{"room":"lab"},"names":{"services":{"servo":"left arm"}}})"));
    const auto description = described();
    EXPECT_EQ(description["labels"]["room"], "lab");
    EXPECT_EQ(description["names"]["services"]["servo"], "left arm");
    EXPECT_THAT(bench.board.executed, IsEmpty()) << "nothing of it goes to the board";
}

TEST_F(LabelledBridge, SecondRequestWhileTheFirstIsWritten_WaitsForItsTurn) {
    ask({{"labels", {{"room", "lab"}}}}, "1");
    ask({{"labels", {{"floor", "2"}}}}, "2");
    EXPECT_EQ(bench.to_keep.size(), 1u);
    bench.labels_kept();
    ASSERT_EQ(bench.to_keep.size(), 2u);
    EXPECT_EQ(bench.to_keep[1].labels.size(), 2u);
    bench.labels_kept();
    ASSERT_EQ(bench.on("answers").size(), 2u);
    EXPECT_EQ(json::parse(bench.on("answers")[1])["answer"]["labels"].size(), 2u);
}

TEST_F(LabelledBridge, DiskThatFails_IsAnsweredAndNothingHasChanged) {
    ask({{"labels", {{"room", "lab"}}}});
    bench.labels_kept(fail("/var/lib/asip: No space left on device"));
    const auto answer = json::parse(bench.on("answers").at(0));
    EXPECT_EQ(answer["status"], "refused");
    EXPECT_EQ(answer["reason"], "not-kept");
    EXPECT_THAT(answer["error"], HasSubstr("No space left"));
    EXPECT_FALSE(described().contains("labels"));
}

TEST_F(LabelledBridge, WhatChangesNothing_IsAnsweredAtOnce) {
    EXPECT_EQ(ask({{"labels", json::object()}})["answer"], json::object());
    EXPECT_EQ(ask({{"labels", {{"room", nullptr}}}}, "2")["status"], "ok");
    EXPECT_THAT(bench.to_keep, IsEmpty());
}

TEST_F(LabelledBridge, WhatCannotBe_IsRefused) {
    const auto why = [this](json request) { return ask(std::move(request))["error"].get<std::string>(); };
    EXPECT_THAT(why({{"labels", {{"my room", "x"}}}}), HasSubstr("is not a key"));
    EXPECT_THAT(why({{"labels", {{"room", "x\n"}}}}), HasSubstr("/labels/room: holds control characters"));
    EXPECT_THAT(why({{"names", {{"services", {{"sevo", "x"}}}}}}), HasSubstr(R"(did you mean "servo"?)"));
    EXPECT_THAT(why({{"names", {{"pins", {{"200", "x"}}}}}}), HasSubstr("the board has pins 0 to"));
    EXPECT_THAT(why({{"labels", json::object()}, {"room", "lab"}}), HasSubstr("/room: is unknown"));
    json many;
    for (int i = 0; i < 33; ++i)
        many["labels"]["k" + std::to_string(i)] = "v";
    EXPECT_THAT(why(many), HasSubstr("more than 32"));
    EXPECT_THAT(bench.to_keep, IsEmpty());
}

TEST_F(LabelledBridge, RetainedRequest_ChangesNothing) {
    bench.hear(kRequests, R"({"labels":{"room":"lab"}})", true);
    EXPECT_THAT(bench.to_keep, IsEmpty());
}

TEST_F(LabelledBridge, MoreRequestsThanMayWait_AreRefused) {
    for (std::size_t i = 0; i <= LabelBook::kMaxWaiting; ++i)
        ask({{"labels", {{"n", std::to_string(i)}}}}, std::to_string(i));
    const auto answers = bench.on("answers");
    ASSERT_EQ(answers.size(), 1u);
    EXPECT_EQ(json::parse(answers[0])["reason"], "queue-full");
}

TEST_F(LabelledBridge, RefusalsThatNobodyWaitsFor_AreLoggedAtALimitedRate) {
    const auto logged = bench.logged;
    for (int i = 0; i < 1000; ++i)
        bench.hear(kRequests, R"({"labels":{"my room":"x"}})");
    EXPECT_GT(bench.logged, logged);
    EXPECT_LE(bench.logged, logged + 21);
}

TEST_F(LabelledBridge, BoardThatIsAway_CanBeLabelled) {
    bench.unplug();
    ask({{"labels", {{"room", "lab"}}}});
    bench.labels_kept();
    EXPECT_EQ(described()["labels"]["room"], "lab");
}

TEST_F(LabelledBridge, WhoDidIt_IsNoted) {
    ask({{"labels", {{"room", "lab"}}}, {"by", "anna"}});
    bench.labels_kept();
    const auto notes = bench.on("asip/servicebus/uno1/$commands");
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_EQ(json::parse(notes[0])["request"], R"({"labels":{"room":"lab"}})");
}

BridgeOptions with_labels(Expected<model::Labels> kept) {
    auto options = BridgeBench::defaults();
    options.labels.labels = {{"room", "lab"}};
    options.load_labels = [kept](const std::string& board) {
        EXPECT_EQ(board, "uno1");
        return kept;
    };
    return options;
}

json labels_after_start(BridgeBench& bench) {
    bench.go_online();
    return json::parse(bench.on(kDescribed).back()).value("labels", json::object());
}

TEST(KeptLabels, AreThereAfterTheStart_AndThoseOfTheConfigurationCountFirst) {
    BridgeBench bench(with_labels(model::Labels{{{"room", "hall"}, {"floor", "2"}}, {}, {}}));
    EXPECT_EQ(labels_after_start(bench), json::parse(R"({"room":"lab","floor":"2"})"));
    EXPECT_THAT(bench.ask(kRequests, {{"labels", {{"room", "x"}}}})["error"],
                HasSubstr("(--label): change it there"));
}

TEST(KeptLabels, ThatCannotBeRead_AreToldUntilOthersAreSet) {
    BridgeBench bench(with_labels(fail("/var/lib/asip/labels/uno1.json: not JSON; mend it")));
    EXPECT_EQ(labels_after_start(bench), json::parse(R"({"room":"lab"})"));
    EXPECT_THAT(bench.notices, testing::Contains("labels cannot be read"));
    const std::string fault = "/var/lib/asip/labels/uno1.json: not JSON; mend it";
    EXPECT_EQ(json::parse(bench.on(kDescribed).back())["labels_fault"], fault);
    EXPECT_EQ(bench.ask(kRequests, {{"labels", {{"floor", nullptr}}}})["error"], fault)
        << "nobody knows whether there was one";
    EXPECT_EQ(bench.ask(kRequests, {{"labels", json::object()}}, "2")["answer"]["labels_fault"], fault);
    EXPECT_THAT(bench.to_keep, IsEmpty());
    bench.ask(kRequests, {{"labels", {{"floor", "2"}}}}, "3");
    ASSERT_EQ(bench.to_keep.size(), 1u);
    bench.labels_kept(std::filesystem::path("/var/lib/asip/labels/uno1.json.damaged"));
    const auto answer = json::parse(bench.on("answers").back())["answer"];
    EXPECT_EQ(answer["set_aside"], "/var/lib/asip/labels/uno1.json.damaged");
    EXPECT_EQ(answer["labels"]["floor"], "2");
    bench.pass(1500ms);
    EXPECT_FALSE(json::parse(bench.on(kDescribed).back()).contains("labels_fault"));
}

TEST(KeptLabels, WithThoseOfTheConfigurationTooMany_AreLeftOut) {
    model::Labels kept;
    for (std::size_t i = 0; i < model::kMaxLabels; ++i)
        kept.labels["k" + std::to_string(i)] = "v";
    BridgeBench bench(with_labels(kept));
    const auto labels = labels_after_start(bench);
    EXPECT_EQ(labels.size(), model::kMaxLabels) << "a description with more is read by nobody";
    EXPECT_EQ(labels["room"], "lab");
}

}  // namespace
}  // namespace asip::agent
