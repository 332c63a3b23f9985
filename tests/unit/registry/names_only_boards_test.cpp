// SPDX-License-Identifier: Apache-2.0
#include "registry/names_only_boards.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "messages.hpp"

namespace asip::registry {
namespace names_only_boards_test {

class NamesOnlyBoardsTest : public testing::Test {
  protected:
    static Port record(NamesOnlyBoardsTest& test) {
        Port port;
        port.publish = [&test](mqtt::Message message) { test.published.push_back(message); };
        port.subscribe = [&test](std::string filter, bool) { test.filters.insert(filter); };
        port.unsubscribe = [&test](const std::string& filter) { test.filters.erase(filter); };
        return port;
    }

    bus::Topics topics;
    std::vector<mqtt::Message> published;
    std::set<std::string> filters;
    NamesOnlyBoards boards{topics, record(*this)};
};

TEST_F(NamesOnlyBoardsTest, BoardThatSoonDescribesItself_IsLeftAlone) {
    boards.add("uno1", at(0s));
    boards.tick(at(500ms));
    boards.remove("uno1");
    boards.tick(at(5s));
    EXPECT_TRUE(published.empty());
    EXPECT_TRUE(filters.empty());
}

TEST_F(NamesOnlyBoardsTest, BoardWithoutDescription_IsListenedToAndAskedThreeTimes) {
    boards.add("uno1", at(0s));
    boards.tick(at(1s));
    EXPECT_THAT(filters, testing::ElementsAre("asip/servicebus/uno1/$description", "asip/uno1/+/out",
                                              "asip/uno1/out"));
    EXPECT_TRUE(published.empty()) << "what the broker retains is asked for first";
    for (Duration time = 1s; time < 60s; time += 100ms)
        boards.tick(at(time));
    ASSERT_EQ(published.size(), 2u);
    EXPECT_EQ(published[0].topic, "asip/servicebus/$probe");
    EXPECT_EQ(published[0].payload, "uno1");
    EXPECT_THAT(filters, testing::ElementsAre("asip/uno1/+/out", "asip/uno1/out"));
    boards.remove("uno1");
    EXPECT_TRUE(filters.empty());
}

TEST_F(NamesOnlyBoardsTest, BoardAnswers_ItsSubscriptionsEnd) {
    boards.add("uno1", at(0s));
    boards.tick(at(1s));
    boards.remove("uno1");
    EXPECT_TRUE(filters.empty());
    boards.tick(at(60s));
    EXPECT_TRUE(published.empty());
}

TEST_F(NamesOnlyBoardsTest, ThousandsAtOnce_AreAskedAFewAtATimeAndAllInTheEnd) {
    constexpr std::size_t kBoards = 1000;
    for (std::size_t i = 0; i < kBoards; ++i)
        boards.add("esp" + std::to_string(i), at(0s));
    std::set<std::string> asked;
    std::size_t probes_before = 0;
    for (Duration time = 1s; time < 15min; time += 500ms) {
        boards.tick(at(time));
        const auto open = std::count_if(filters.begin(), filters.end(),
                                        [](const auto& filter) { return filter.ends_with("$description"); });
        EXPECT_LE(open, static_cast<long>(NamesOnlyBoards::kMaxOpen));
        EXPECT_LE(published.size() - probes_before, NamesOnlyBoards::kMaxProbes);
        probes_before = published.size();
    }
    for (const auto& probe : published)
        asked.insert(probe.payload);
    EXPECT_EQ(asked.size(), kBoards);
    EXPECT_EQ(published.size(), 2 * kBoards);
    EXPECT_EQ(filters.size(), 2 * kBoards) << "listened to, and asked nothing more";
}

TEST_F(NamesOnlyBoardsTest, BoardsThatAnswerWhileAsked_MakeRoomForOthers) {
    for (std::size_t i = 0; i < NamesOnlyBoards::kMaxOpen; ++i)
        boards.add("a" + std::to_string(i), at(0s));
    boards.tick(at(1s));
    boards.add("b", at(1s));
    boards.tick(at(2s));
    EXPECT_EQ(filters.count("asip/servicebus/b/$description"), 0u);
    EXPECT_EQ(filters.count("asip/b/out"), 1u) << "its traffic renews its lease meanwhile";
    boards.remove("a7");
    boards.tick(at(2100ms));
    EXPECT_EQ(filters.count("asip/servicebus/b/$description"), 1u);
}

TEST_F(NamesOnlyBoardsTest, TooMany_AllTrafficIsHeardUntilHalfOfThemAreLeft) {
    const auto name = [](std::size_t i) { return "esp" + std::to_string(i); };
    const std::size_t count = NamesOnlyBoards::kMaxListened + 1;
    for (std::size_t i = 0; i < count; ++i)
        boards.add(name(i), at(0s));
    boards.tick(at(1s));
    boards.tick(at(1s + NamesOnlyBoards::kQuestionTime));
    std::erase_if(filters, [](const auto& filter) { return filter.ends_with("$description"); });
    EXPECT_THAT(filters, testing::ElementsAre("asip/+/+/out", "asip/+/out"));
    for (std::size_t i = count; i-- > NamesOnlyBoards::kMaxListened / 2;)
        boards.remove(name(i));
    EXPECT_EQ(filters.size(), NamesOnlyBoards::kMaxListened);
    EXPECT_EQ(filters.count("asip/+/out"), 0u);
    EXPECT_EQ(filters.count("asip/esp0/out"), 1u);
}

}  // namespace names_only_boards_test
}  // namespace asip::registry
