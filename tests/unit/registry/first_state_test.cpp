// SPDX-License-Identifier: Apache-2.0
// Messages and time in; what is asked, and what the catalogue then holds, out.
#include "registry/first_state.hpp"

#include <gmock/gmock.h>

#include <deque>
#include <nlohmann/json.hpp>

#include "messages.hpp"
#include "registry/query_endpoint.hpp"

namespace asip::registry {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kMany = 100;
const std::string kOwnQuery = "asip/registry/r1/query";

/// A registry that has its state, or is still reading it.
struct OtherRegistry {
    explicit OtherRegistry(const std::string& id)
        : queries(id, {catalogue, [this] { return now; }, [] { return 7u; }, {}, {}}) {
        queries.set_epoch(id + "-1");
        catalogue.resume(at(0s));
    }
    void describe(std::size_t boards) {
        for (std::size_t i = 0; i < boards; ++i)
            catalogue.apply(description("board" + std::to_string(1000 + i)).view(), now.time);
    }
    std::string answer(const mqtt::Message& question) {
        std::string text;
        QueryEndpoint endpoint(
            queries, [&text](const mqtt::Message& answer) { text = answer.payload; },
            [](const std::string&) { return true; });
        endpoint.request(question, false, now.time);
        return text;
    }

    Instant now = instant(at(0s));
    Catalogue catalogue;
    Queries queries;
};

class FirstStateTest : public testing::Test {
  protected:
    FirstState::Dependencies dependencies() {
        FirstState::Dependencies result;
        result.publish = [this](mqtt::Message message) { sent.push_back(std::move(message)); };
        result.read_retained = [this] { log.emplace_back("retained"); };
        result.probe = [this] { log.emplace_back("probe"); };
        result.apply = [this](const Announcement& announcement) {
            ASSERT_TRUE(announcement.retained) << "what others say is a hint";
            catalogue.apply(announcement, now);
        };
        result.complete = [this] { log.emplace_back("complete"); };
        return result;
    }
    /// What others that are online say of themselves, and then the mark that was sent behind it.
    void others_say(const std::vector<std::pair<std::string, std::size_t>>& boards) {
        for (const auto& [id, count] : boards) {
            first.state(id, "online");
            first.statistics(id, R"({"boards":{"lost":1,"online":)" + std::to_string(count - 1) + "}}");
        }
        back_comes_the_mark();
    }
    void back_comes_the_mark() {
        const auto mark = next_sent();
        EXPECT_EQ(mark.topic, kOwnQuery);
        EXPECT_TRUE(first.mark(mark.payload, now));
    }
    mqtt::Message next_sent() {
        if (sent.empty()) {
            ADD_FAILURE() << "nothing was sent";
            return {};
        }
        auto message = std::move(sent.front());
        sent.pop_front();
        return message;
    }
    /// Whatever is asked, the other one answers. Returns how often.
    int serve(OtherRegistry& other, int most = 1000) {
        int pages = 0;
        while (pages < most && first.copying() && !sent.empty()) {
            ++pages;
            first.answer(other.answer(next_sent()), now);
        }
        return pages;
    }

    Time now = at(0s);
    std::deque<mqtt::Message> sent;
    std::vector<std::string> log;
    Catalogue catalogue;
    FirstState first{bus::Topics(), "r1", "asip/reply/x", kMany, dependencies()};
};

TEST_F(FirstStateTest, NobodyElse_RetainedMessagesAreReadAndThenItIsWhole) {
    first.begin("aa", false, now);
    EXPECT_THAT(log, IsEmpty());
    others_say({});
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
    EXPECT_TRUE(first.active());
    back_comes_the_mark();
    EXPECT_THAT(log, ElementsAre("retained", "probe", "complete"));
    EXPECT_FALSE(first.active());
}

TEST_F(FirstStateTest, RetainedComesByItself_IsNotAskedForAgain) {
    first.begin("aa", true, now);
    EXPECT_THAT(log, ElementsAre("probe"));
    back_comes_the_mark();
    EXPECT_THAT(log, ElementsAre("probe", "complete"));
}

TEST_F(FirstStateTest, OthersHaveFewBoards_RetainedMessagesAreRead) {
    first.begin("aa", false, now);
    others_say({{"r1", 5000}, {"r2", kMany - 1}});
    EXPECT_THAT(log, ElementsAre("retained", "probe")) << "r1 is this registry, before it started again";
}

TEST_F(FirstStateTest, OthersAreGone_TheirStatisticsCountForNothing) {
    first.begin("aa", false, now);
    for (const char* word : {"lost", "offline", "", "\xff"})
        first.state("r2", word);
    first.statistics("r2", R"({"boards":{"online":100000}})");
    first.statistics("r3", R"({"boards":{"online":100000}})");
    back_comes_the_mark();
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
}

TEST_F(FirstStateTest, ManyThatDoNotAnswer_AreNotAllAsked) {
    first.begin("aa", false, now);
    std::vector<std::pair<std::string, std::size_t>> forged;
    for (int i = 0; i < 5000; ++i)
        forged.emplace_back("forged" + std::to_string(i), kMany + 1);
    others_say(forged);
    for (std::size_t i = 1; i <= FirstState::kMostAsked; ++i) {
        EXPECT_EQ(sent.size(), i);
        EXPECT_THAT(log, IsEmpty());
        first.tick(now += FirstState::kAnswerTime);
    }
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
}

TEST_F(FirstStateTest, OtherHasMany_ItsPagesMakeTheSameCatalogue) {
    OtherRegistry other("r2");
    other.describe(kMany + 30);
    other.catalogue.apply(state("board1003", "lost").view(), at(0s));
    other.catalogue.apply(state("board1004", "offline").view(), at(0s));
    other.catalogue.apply(state("board1005", "sleeping").view(), at(0s));
    other.catalogue.apply(
        description("zed", {.session = "77", .seq = 9, .more = R"("labels":{"room":"a"})"}).view(), at(0s));
    first.begin("aa", false, now);
    others_say({{"r2", kMany + 31}, {"r3", kMany}});
    EXPECT_EQ(sent.front().topic, "asip/registry/r2/query") << "who knows most";
    EXPECT_EQ(serve(other), 3);
    EXPECT_THAT(log, ElementsAre("complete")) << "boards are not asked: they renew their leases anyway";
    EXPECT_EQ(first.from(), "r2");
    EXPECT_EQ(catalogue.fingerprint(), other.catalogue.fingerprint());
    EXPECT_EQ(catalogue.check(), "");
}

TEST_F(FirstStateTest, LeaseThatHasRunForAWhile_RunsOutInTime) {
    OtherRegistry other("r2");
    other.describe(kMany);
    now = at(50s);
    other.now = instant(now);
    other.catalogue.apply(description("board1000", {.seq = 2}).view(), now);
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    serve(other);
    catalogue.resume(now);  // with the grace of a registry that hears the bus again
    for (; now < at(65s); now += 100ms)
        catalogue.expire(now);
    EXPECT_EQ(catalogue.board("board1000", instant(now))->state, "online");
    EXPECT_EQ(catalogue.board("board1001", instant(now))->state, "lost");
}

TEST_F(FirstStateTest, LeaseThatHasRunOut_BoardIsLost) {
    OtherRegistry other("r2");
    other.describe(kMany);
    now = at(100s);
    other.now = instant(now);
    other.catalogue.expire(now);
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    serve(other);
    EXPECT_EQ(catalogue.board("board1001", instant(now))->state, "lost");
    EXPECT_EQ(catalogue.fingerprint(), other.catalogue.fingerprint());
}

TEST_F(FirstStateTest, AnnouncedWhilePagesAreRead_OlderPageChangesNothing) {
    OtherRegistry other("r2");
    other.describe(kMany);
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    serve(other, 1);
    catalogue.apply(description("board1090", {.seq = 5, .chip = "ATmega2560"}).view(), now);
    catalogue.apply(state("board1091", "offline").view(), now);
    serve(other);
    EXPECT_EQ(catalogue.board("board1090", instant(now))->seq, 5u);
    EXPECT_EQ(catalogue.board("board1090", instant(now))->chip, "ATmega2560");
    EXPECT_EQ(catalogue.board("board1091", instant(now))->state, "offline");
}

TEST_F(FirstStateTest, OtherDoesNotAnswer_TheNextOneIsAskedAndThenRetainedMessagesAreRead) {
    OtherRegistry second("r3");
    second.describe(kMany);
    first.begin("aa", false, now);
    others_say({{"r2", kMany + 1}, {"r3", kMany}});
    next_sent();
    first.tick(now += FirstState::kAnswerTime - 1ms);
    EXPECT_THAT(sent, IsEmpty());
    first.tick(now += 1ms);
    EXPECT_EQ(sent.front().topic, "asip/registry/r3/query");
    serve(second, 1);
    EXPECT_EQ(catalogue.size(), FirstState::kPage);
    first.tick(now += FirstState::kAnswerTime);
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
    EXPECT_EQ(first.from(), "");
    sent.erase(sent.begin());
    back_comes_the_mark();
    EXPECT_EQ(log.back(), "complete");
}

TEST_F(FirstStateTest, OtherIsStillReadingItself_IsNotBelieved) {
    OtherRegistry other("r2");
    other.queries.set_settling(true);
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    serve(other);
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
}

TEST_F(FirstStateTest, OtherStartsAgainBetweenPages_RetainedMessagesAreRead) {
    OtherRegistry other("r2");
    other.describe(kMany);
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    serve(other, 1);
    other.queries.set_epoch("r2-2");
    serve(other);
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
}

TEST_F(FirstStateTest, PagesWithoutEnd_AreGivenUp) {
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    const auto page = [&](const char* items) {
        const auto id = nlohmann::json::parse(next_sent().payload).at("id").get<std::string>();
        first.answer(R"({"id":")" + id +
                         R"(","registry":"r2","epoch":"e","find":"boards","cursor":"x","items":)" + items +
                         "}",
                     now);
    };
    page(R"([{"board":"b"},{"board":"c"}])");
    EXPECT_TRUE(first.copying());
    page(R"([{"board":"c"}])");
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
}

TEST_F(FirstStateTest, EmptyPageThatPromisesMore_IsGivenUp) {
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    const auto id = nlohmann::json::parse(next_sent().payload).at("id").get<std::string>();
    first.answer(R"({"id":")" + id + R"(","registry":"r2","cursor":"x","items":[]})", now);
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
}

TEST_F(FirstStateTest, AnswersThatAreNone_AreNoReasonToStop) {
    OtherRegistry other("r2");
    other.describe(kMany);
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    for (const char* text :
         {"", "{", "[]", "\xff\xfe", R"({"id":"aa-2","registry":"r2","items":[{"board":"x"}]})"})
        first.answer(text, now);
    serve(other);
    EXPECT_THAT(log, ElementsAre("complete"));
    EXPECT_EQ(catalogue.size(), kMany);
}

TEST_F(FirstStateTest, StatisticsThatAreNone_CountForNothing) {
    first.begin("aa", false, now);
    first.state("r2", "online");
    for (const char* text : {"", "{", "[]", "\xff", R"({"boards":7})",
                             R"({"boards":{"online":-5,"lost":"many"}})", R"({"boards":{"online":1e300}})"})
        first.statistics("r2", text);
    back_comes_the_mark();
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
}

TEST_F(FirstStateTest, MarksAreLost_ItGoesOnAllTheSame) {
    first.begin("aa", false, now);
    first.tick(now += FirstState::kAnswerTime);
    EXPECT_THAT(log, ElementsAre("retained", "probe"));
    first.tick(now += FirstState::kRetainedTime - 1ms);
    EXPECT_TRUE(first.active());
    first.tick(now += 1ms);
    EXPECT_THAT(log, ElementsAre("retained", "probe", "complete"));
}

TEST_F(FirstStateTest, RetainedMessagesThatTakeLong_AreWaitedFor) {
    first.begin("aa", true, now);
    for (int i = 0; i < 100; ++i) {
        first.retained_came(now += 1s);
        first.tick(now);
    }
    EXPECT_THAT(log, ElementsAre("probe"));
    first.tick(now += FirstState::kRetainedTime);
    EXPECT_THAT(log, ElementsAre("probe", "complete"));
}

TEST_F(FirstStateTest, ConnectionLostBetweenPages_TheNextBeginsAnew) {
    OtherRegistry other("r2");
    other.describe(kMany);
    first.begin("aa", false, now);
    others_say({{"r2", kMany}});
    const auto old = next_sent();
    first.end();
    first.begin("bb", false, now);
    first.answer(other.answer(old), now);
    EXPECT_EQ(catalogue.size(), 0u);
    others_say({{"r2", kMany}});
    serve(other);
    EXPECT_THAT(log, ElementsAre("complete"));
    EXPECT_EQ(catalogue.size(), kMany);
}

}  // namespace
}  // namespace asip::registry
