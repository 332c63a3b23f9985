// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/router.hpp"

#include <gmock/gmock.h>

#include <optional>
#include <vector>

namespace asip::mqtt {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Message on(std::string topic) {
    Message message;
    message.topic = std::move(topic);
    return message;
}

TEST(TopicMatches, WildcardsAsMqttHasThem) {
    EXPECT_TRUE(topic_matches("asip/+/out", "asip/uno1/out"));
    EXPECT_TRUE(topic_matches("asip/#", "asip/uno1/io/out"));
    EXPECT_TRUE(topic_matches("asip/#", "asip"));
    EXPECT_FALSE(topic_matches("asip/+/out", "asip/uno1/io/out"));
    EXPECT_FALSE(topic_matches("asip/+", "asip"));
    EXPECT_FALSE(topic_matches("+/x", "$SYS/x"));
    EXPECT_FALSE(topic_matches("", "a"));
    EXPECT_FALSE(topic_matches("asip/a", "asip/a/b"));
    EXPECT_FALSE(topic_matches("asip/a/b", "asip/a"));
    EXPECT_TRUE(topic_matches("+/+", "a/"));
    EXPECT_FALSE(topic_matches("a/+", "a/+")) << "a filter is no topic";
}

TEST(Router, EachMatchingSubscription_IsCalled) {
    Router router;
    std::vector<std::string> heard;
    const auto a = router.add("x/+", [&](const Message& m) { heard.push_back("a " + m.topic); });
    const auto b = router.add("x/1", [&](const Message& m) { heard.push_back("b " + m.topic); });
    router.dispatch(on("x/1"));
    router.dispatch(on("x/2"));
    EXPECT_THAT(heard, ElementsAre("a x/1", "b x/1", "a x/2"));
}

TEST(Router, HandleEnded_CallbackIsGoneAndItsFilterUnusedOnce) {
    std::vector<std::string> unused;
    Router router([&](const std::string& filter) { unused.push_back(filter); });
    auto witness = std::make_shared<int>(1);
    std::weak_ptr<int> alive = witness;
    auto first = router.add("x", [witness](const Message&) { FAIL(); });
    auto second = router.add("x", [](const Message&) {});
    witness.reset();
    first.reset();
    EXPECT_TRUE(alive.expired());
    EXPECT_THAT(unused, IsEmpty());
    router.dispatch(on("x"));
    second.reset();
    EXPECT_THAT(unused, ElementsAre("x"));
}

/// As a command does: waits a moment for what it subscribed to, and returns.
bool heard_within_a_frame(Router& router) {
    bool heard = false;
    const auto subscription = router.add("late", [&heard](const Message&) { heard = true; });
    router.dispatch(on("other"));
    return heard;
}

TEST(Router, MessageForAFrameThatReturned_ReachesNobody) {
    Router router;
    EXPECT_FALSE(heard_within_a_frame(router));
    std::string next_frame(64, 'x');
    router.dispatch(on("late"));
    EXPECT_EQ(next_frame, std::string(64, 'x'));
}

TEST(Router, EndedByAnotherCallbackOfTheSameMessage_IsNotCalled) {
    Router router;
    std::optional<Router::Subscription> later;
    int calls = 0;
    const auto first = router.add("x", [&](const Message&) { later.reset(); });
    later = router.add("x", [&](const Message&) { ++calls; });
    router.dispatch(on("x"));
    EXPECT_EQ(calls, 0);
}

TEST(Router, EndedInsideItsOwnCallback_MayStillUseWhatItCaptured) {
    Router router;
    std::optional<Router::Subscription> own;
    std::string seen;
    own = router.add("x", [&, text = std::string(100, 'x')](const Message&) {
        own.reset();
        seen = text;
    });
    router.dispatch(on("x"));
    router.dispatch(on("x"));
    EXPECT_EQ(seen, std::string(100, 'x'));
}

TEST(Router, AddedInsideACallback_HearsTheNextMessage) {
    Router router;
    std::vector<Router::Subscription> added;
    int calls = 0;
    const auto first = router.add(
        "x", [&](const Message&) { added.push_back(router.add("x", [&](const Message&) { ++calls; })); });
    router.dispatch(on("x"));
    EXPECT_EQ(calls, 0);
    router.dispatch(on("x"));
    EXPECT_EQ(calls, 1);
}

TEST(Router, GoneBeforeItsHandles_LeavesThemHarmless) {
    std::optional<Router::Subscription> handle;
    {
        Router router([](const std::string&) { FAIL(); });
        handle = router.add("x", [](const Message&) {});
    }
    handle.reset();
}

}  // namespace
}  // namespace asip::mqtt
