// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/value_feed.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "clock.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;
using testing::ElementsAre;

class ValueFeedTest : public testing::Test {
  protected:
    void report(const std::string& service, const std::string& payload,
                std::chrono::milliseconds time = 0ms) {
        values_.value("uno1", service, payload, false, at(time));
    }
    void distances(int from, int to) {
        for (int cm = from; cm <= to; ++cm)
            report("distance", R"({"distance":[)" + std::to_string(cm) + "]}");
    }
    ValueFeed::Options one() const {
        return {.board = "uno1",
                .service = "distance",
                .max_hz = 0,
                .after = {},
                .after_each = {},
                .allowed = {}};
    }
    // "value 3 [7]": kind, number of the place ("-" for none), the value.
    static std::string shown(const StreamEvent& event) {
        const auto place = parse_place(event.place);
        const auto data = json::parse(event.data);
        std::string text(event.kind);
        text += place ? " " + std::to_string(place->number) : std::string(" -");
        if (data.contains("value")) text += " " + data["value"].dump();
        if (data.contains("left_out")) text += " left out " + data["left_out"].dump();
        if (data.contains("reason")) text += " " + data["reason"].get<std::string>();
        return text;
    }
    static std::vector<std::string> read(Feed& feed, std::chrono::milliseconds time = 0ms) {
        std::vector<std::string> all;
        for (StreamEvent event; feed.next(event, at(time));)
            all.push_back(shown(event));
        return all;
    }

    Values values_{"e1"};
};

TEST_F(ValueFeedTest, Begin_LastValueThenSnapshotEndThenEachNewOne) {
    distances(1, 3);
    ValueFeed feed(values_, one());
    EXPECT_THAT(read(feed), ElementsAre(R"(value - {"distance":[3]})", "snapshot-end 3"));
    distances(4, 5);
    EXPECT_THAT(read(feed), ElementsAre(R"(value 4 {"distance":[4]})", R"(value 5 {"distance":[5]})"));
    EXPECT_THAT(read(feed), ElementsAre());
}

TEST_F(ValueFeedTest, EmptyPattern_IsAnyService_AndAFeedThatEndedHearsNothing) {
    distances(1, 1);
    const auto any = [&] {
        auto options = one();
        options.service.clear();
        return std::make_unique<ValueFeed>(values_, std::move(options));
    };
    auto feed = any();
    report("servo", R"({"servo":[90]})");
    EXPECT_THAT(read(*feed),
                ElementsAre(R"(value 1 {"distance":[1]})", "snapshot-end 0", R"(value 1 {"servo":[90]})"));
    feed.reset();
    report("servo", R"({"servo":[91]})");  // the sanitizers see a feed that is still called
    EXPECT_EQ(read(*any()).size(), 3u);
}

TEST_F(ValueFeedTest, NothingHeardYet_SnapshotIsEmptyAndTheFirstValueComes) {
    ValueFeed feed(values_, one());
    EXPECT_THAT(read(feed), ElementsAre("snapshot-end 0"));
    distances(1, 1);
    EXPECT_THAT(read(feed), ElementsAre(R"(value 1 {"distance":[1]})"));
}

TEST_F(ValueFeedTest, AgeOfTheSnapshot_IsInSeconds) {
    report("distance", "[1]", 0ms);
    ValueFeed feed(values_, one());
    StreamEvent event;
    ASSERT_TRUE(feed.next(event, at(2500ms)));
    EXPECT_EQ(json::parse(event.data)["age"], 2.5);
    EXPECT_EQ(json::parse(event.data)["at"], "2023-11-14T22:13:20.000Z");
}

// What a reader of a pattern keeps, as documented: the last place of each service.
struct PatternReader {
    std::map<std::string, std::vector<std::uint64_t>> seen;  // by "BOARD/SERVICE"; a snapshot's number first
    Places places{"e1", {}, {}};

    void take(Feed& feed, int limit) {
        for (StreamEvent event; limit-- > 0 && feed.next(event, at(0ms));) {
            ASSERT_NE(event.kind, "reset");
            const auto place = parse_place(event.place);
            if (event.kind == "snapshot-end") {
                places.others = place->number;
            } else {
                const auto data = json::parse(event.data);
                const auto service =
                    data["board"].get<std::string>() + "/" + data["service"].get<std::string>();
                ASSERT_TRUE(place) << event.data;
                places.services[service] = place->number;
                seen[service].push_back(place->number);
                EXPECT_FALSE(data.contains("left_out")) << event.data;
            }
        }
    }
};

// Three services, one of which reports for the first time while no client listens. The connection is cut
// behind each event in turn, those of the snapshot included.
TEST_F(ValueFeedTest, PatternCutAtEveryEvent_ResumesEachServiceWithoutGapOrDuplicate) {
    for (int cut = 0; cut <= 24; ++cut) {
        Values values("e1");
        const auto put = [&](const std::string& board, int times) {
            for (int i = 0; i < times; ++i)
                values.value(board, "distance", "[1]", false, at(0ms));
        };
        const auto options = [] {
            return ValueFeed::Options{
                .board = "uno*", .service = "d*", .max_hz = 0, .after = {}, .after_each = {}, .allowed = {}};
        };
        put("uno1", 3);
        put("uno2", 1);
        PatternReader reader;
        {
            ValueFeed first(values, options());
            reader.take(first, std::min(cut, 3));
            put("uno1", 5);
            put("uno2", 5);
            put("uno3", 5);
            put("other", 5);
            reader.take(first, cut - 3);
        }
        put("uno3", 2);
        put("uno4", 3);
        put("uno1", 100);
        auto again = options();
        again.after_each = reader.places;
        ValueFeed second(values, std::move(again));
        reader.take(second, 1000);
        put("uno2", 1);
        put("uno5", 2);
        reader.take(second, 1000);
        EXPECT_EQ(reader.seen.count("other/distance"), 0u);
        for (const auto& [board, last] : std::map<std::string, std::uint64_t>{
                 {"uno1", 108}, {"uno2", 7}, {"uno3", 7}, {"uno4", 3}, {"uno5", 2}}) {
            const auto& numbers = reader.seen[board + "/distance"];
            ASSERT_FALSE(numbers.empty()) << board << ", cut behind " << cut;
            EXPECT_EQ(numbers.back(), last) << board << ", cut behind " << cut;
            for (std::size_t i = 1; i < numbers.size(); ++i)
                EXPECT_EQ(numbers[i], numbers[i - 1] + 1) << board << ", cut behind " << cut;
            // What was not there when its reader began is read from its first value on.
            if (board > "uno2" && cut >= 3) {
                EXPECT_EQ(numbers.front(), 1u) << board << ", cut behind " << cut;
            }
        }
    }
}

TEST_F(ValueFeedTest, PatternResumedFromWhatIsGone_TheNewestWithTheNumberLeftOut) {
    Values values("e1", {.points = 5});
    for (int i = 0; i < 20; ++i)
        values.value("uno1", "distance", "[1]", false, at(0ms));
    ValueFeed::Options options{.board = "*",
                               .service = "*",
                               .max_hz = 0,
                               .after = {},
                               .after_each = Places{"e1", {{"uno1/distance", 3}}, 0},
                               .allowed = {}};
    ValueFeed feed(values, std::move(options));
    EXPECT_THAT(read(feed), ElementsAre("value 20 [1] left out 16"));
}

TEST_F(ValueFeedTest, PatternResumedFromAnotherRun_ResetAndASnapshot) {
    distances(1, 2);
    ValueFeed::Options options{.board = "*",
                               .service = "*",
                               .max_hz = 0,
                               .after = {},
                               .after_each = Places{"e0", {{"uno1/distance", 1}}, 0},
                               .allowed = {}};
    ValueFeed feed(values_, std::move(options));
    EXPECT_THAT(read(feed),
                ElementsAre("reset - another-epoch", R"(value 2 {"distance":[2]})", "snapshot-end 0"));
}

TEST_F(ValueFeedTest, PatternResumedAfterTheBoardWasForgotten_BeginsWithItsLastValue) {
    distances(1, 2);
    ValueFeed::Options options{.board = "*",
                               .service = "*",
                               .max_hz = 0,
                               .after = {},
                               .after_each = Places{"e1", {{"uno1/distance", 57}}, 0},
                               .allowed = {}};
    ValueFeed feed(values_, std::move(options));
    EXPECT_THAT(read(feed), ElementsAre(R"(value 2 {"distance":[2]})", "snapshot-end 0"));
}

TEST_F(ValueFeedTest, ResumeFromAnotherRun_ResetWithAReasonAndASnapshot) {
    distances(1, 2);
    auto options = one();
    options.after = Place{"e0", 1};
    ValueFeed feed(values_, std::move(options));
    EXPECT_THAT(read(feed),
                ElementsAre("reset - another-epoch", R"(value - {"distance":[2]})", "snapshot-end 2"));
}

TEST_F(ValueFeedTest, ResumeFromWhatIsGone_ResetWithAReason) {
    distances(1, 1300);
    auto options = one();
    options.after = Place{"e1", 3};
    ValueFeed feed(values_, std::move(options));
    EXPECT_EQ(read(feed).front(), "reset - past-gone");
}

TEST_F(ValueFeedTest, SlowReader_GetsTheNewestAndTheNumberLeftOut) {
    ValueFeed feed(values_, one());
    read(feed);
    distances(1, 500);
    EXPECT_THAT(read(feed), ElementsAre(R"(value 500 {"distance":[500]} left out 499)"));
    distances(501, 501);
    EXPECT_THAT(read(feed), ElementsAre(R"(value 501 {"distance":[501]})"));
    EXPECT_EQ(values_.left_out(), 499u);
}

TEST_F(ValueFeedTest, SlowReaderOfParts_GetsThemTogether) {
    auto options = one();
    options.service = "io";
    ValueFeed feed(values_, std::move(options));
    read(feed);
    for (int pin = 2; pin < 80; ++pin)
        report("io", R"({"digital":{")" + std::to_string(pin % 4) + R"(":)" + std::to_string(pin) + "}}");
    report("io", R"({"analog":{"0":7}})");
    EXPECT_THAT(read(feed), ElementsAre(R"(value - {"digital":{"0":76,"1":77,"2":78,"3":79}})",
                                        R"(value 79 {"analog":{"0":7}} left out 77)"));
}

TEST_F(ValueFeedTest, CutInsideWhatStandsForMany_NothingIsLost) {
    auto options = one();
    options.service = "io";
    ValueFeed feed(values_, std::move(options));
    read(feed);
    report("io", R"({"analog":{"0":1}})");
    for (int i = 0; i < 80; ++i)
        report("io", R"({"digital":{"2":1}})");
    StreamEvent event;
    ASSERT_TRUE(feed.next(event, at(0ms)));
    EXPECT_TRUE(event.place.empty()) << "a place here would skip what comes behind it";
    ASSERT_TRUE(feed.next(event, at(0ms)));
    EXPECT_EQ(event.place, "e1-81");
}

TEST_F(ValueFeedTest, MaxHz_NewestAtMostSoOften) {
    auto options = one();
    options.max_hz = 20;
    ValueFeed feed(values_, std::move(options));
    int woken = 0;
    feed.wake = [&] { ++woken; };
    read(feed);
    distances(1, 1);
    EXPECT_THAT(read(feed, 0ms), ElementsAre(R"(value 1 {"distance":[1]})"));
    woken = 0;
    report("distance", "[2]", 10ms);
    report("distance", "[3]", 20ms);
    EXPECT_EQ(woken, 0);
    EXPECT_THAT(read(feed, 20ms), ElementsAre());
    feed.tick(at(60ms));
    EXPECT_EQ(woken, 1);
    EXPECT_THAT(read(feed, 60ms), ElementsAre("value 3 [3] left out 1"));
}

TEST_F(ValueFeedTest, Pattern_ServicesThatComeLaterBelongToIt) {
    auto options = one();
    options.board = "u*";
    options.service = "*";
    ValueFeed feed(values_, std::move(options));
    EXPECT_THAT(read(feed), ElementsAre("snapshot-end 0"));
    report("distance", "[1]");
    report("servo", "[2]");
    values_.value("mega", "servo", "[3]", false, at(0ms));
    EXPECT_THAT(read(feed), ElementsAre("value 1 [1]", "value 1 [2]"));
}

TEST_F(ValueFeedTest, NotAllowed_IsAsIfItWereNotThere) {
    auto options = one();
    options.service = "*";
    options.allowed = [](std::string_view, std::string_view service) { return service == "servo"; };
    report("distance", "[1]");
    ValueFeed feed(values_, std::move(options));
    EXPECT_THAT(read(feed), ElementsAre("snapshot-end 0"));
    report("servo", "[2]");
    report("distance", "[3]");
    EXPECT_THAT(read(feed), ElementsAre("value 1 [2]"));
}

TEST_F(ValueFeedTest, BoardForgotten_NothingOfItIsKept) {
    distances(1, 10);
    ValueFeed feed(values_, one());
    values_.forget("uno1");
    EXPECT_EQ(values_.services(), 0u);
    EXPECT_EQ(values_.bytes(), 0u);
    EXPECT_THAT(read(feed), ElementsAre("snapshot-end 0"));
    distances(1, 1);
    EXPECT_THAT(read(feed), ElementsAre(R"(value 1 {"distance":[1]})"));
}

TEST(Values, BeyondTheirBytes_TheOldestOfAllGiveWayAndTheLastOfEachStays) {
    Values values("e1", {.points = 1000, .age = 1h, .bytes = 20'000, .services = 100, .channels = 4});
    values.value("uno1", "quiet", R"({"a":1})", false, at(0ms));
    for (int i = 0; i < 2000; ++i)
        values.value("uno1", i % 2 == 0 ? "loud" : "louder", "[" + std::to_string(i) + "]", false, at(0ms));
    EXPECT_LE(values.bytes(), 20'000u);
    EXPECT_TRUE(values.find("uno1", "quiet")->points.empty());
    EXPECT_EQ(values.find("uno1", "quiet")->channels.at(0).json(), R"({"a":1})");
    EXPECT_NE(values.find("uno1", "loud")->point(1000), nullptr);
}

TEST(Values, PartsOfAMap_AreTogetherHoweverManyAndWhoeverAsks) {
    Values values("e1");
    const auto last = [&] { return json::parse(values.find("uno1", "io")->channels.at(0).json()); };
    const auto report = [&](const json& value) {
        values.value("uno1", "io", json{{"digital", value}}.dump(), false, at(0ms));
    };
    json all = json::object();
    for (int i = 0; i < 300; ++i) {
        const json part{{std::to_string(i % 20), i}, {"long" + std::to_string(i % 3), std::string(200, 'a')}};
        all.update(part);
        report(part);
        if (i % 7 == 0) {
            EXPECT_EQ(last()["digital"], all) << i;
        }
    }
    EXPECT_EQ(last()["digital"], all);
    report({{"huge", std::string(9000, 'a')}});
    EXPECT_EQ(last()["digital"].size(), 1u) << "too long together: the newest alone";
    report(7);
    report({{"2", 1}});
    EXPECT_EQ(last()["digital"], json({{"2", 1}})) << "behind what is no map";
    EXPECT_EQ(values.find("uno1", "io")->channels.size(), 1u);
}

TEST(Values, OlderThanTheirAge_AreGone) {
    Values values("e1");
    values.value("uno1", "a", "1", false, at(0ms));
    for (int i = 0; i < 1300; ++i)
        values.value("uno1", "b", "2", false, at(1min));
    values.expire(at(10min));
    EXPECT_EQ(values.find("uno1", "a")->points.size(), 1u);
    values.expire(at(10min + 1ms));
    EXPECT_TRUE(values.find("uno1", "a")->points.empty());
    EXPECT_EQ(values.find("uno1", "b")->points.size(), 1200u);
    values.expire(at(1h));
    EXPECT_EQ(values.bytes(), 0u);
}

struct Published {
    std::string payload, json, event;
};

class PublishedValue : public testing::TestWithParam<Published> {};

TEST_P(PublishedValue, IsCompactJsonUnderItsEvent) {
    const auto& [payload, expected, event] = GetParam();
    Values values("e1");
    values.value("uno1", "a", payload, false, at(0ms));
    const auto& channel = values.find("uno1", "a")->channels.at(0);
    EXPECT_EQ(channel.json(), expected);
    EXPECT_EQ(channel.event, event);
    EXPECT_EQ(values.find("uno1", "a")->points.front().json, expected);
    EXPECT_FALSE(json::parse(expected, nullptr, false).is_discarded());
}

INSTANTIATE_TEST_SUITE_P(
    Values, PublishedValue,
    testing::Values(
        Published{R"({"a":1})", R"({"a":1})", "a"}, Published{R"({"a":-1.5})", R"({"a":-1.5})", "a"},
        Published{R"({"a b":{"2":1,"10":[true,null,"e"]}})", R"({"a b":{"2":1,"10":[true,null,"e"]}})",
                  "a b"},
        Published{"{\"a\":\"\xC3\xA4\"}", "{\"a\":\"\xC3\xA4\"}", "a"},
        Published{R"({"":1})", R"({"":1})", ""}, Published{" { \"a\" : [ 1 ,\n2 ] } ", R"({"a":[1,2]})", "a"},
        Published{R"({"a":"x y"})", R"({"a":"x y"})", "a"},
        Published{R"({"\u0061":"\u0041\/"})", R"({"a":"A/"})", "a"},
        Published{R"({"a":1E3})", R"({"a":1000.0})", "a"},
        Published{R"({"a":1e999})", R"("{\"a\":1e999}")", ""},
        Published{R"({"a":1,"a":2})", R"({"a":2})", "a"},
        Published{R"({"b":1,"a":2})", R"({"a":2,"b":1})", ""},
        Published{R"({"a":1}x)", R"("{\"a\":1}x")", ""}, Published{R"({"a":01})", R"("{\"a\":01}")", ""},
        Published{"{\"a\":\"\xff\"}", "\"{\\\"a\\\":\\\"\xEF\xBF\xBD\\\"}\"", ""},
        Published{"{\"" + std::string(65, 'a') + "\":1}", "{\"" + std::string(65, 'a') + "\":1}", ""},
        Published{"{\"a\":\"" + std::string(400, 'a') + "\"}", "{\"a\":\"" + std::string(400, 'a') + "\"}",
                  "a"},
        Published{"{\"a\":" + std::string(15, '[') + std::string(15, ']') + "}",
                  "{\"a\":" + std::string(15, '[') + std::string(15, ']') + "}", "a"},
        Published{"{\"a\":" + std::string(16, '[') + std::string(16, ']') + "}",
                  "\"{\\\"a\\\":" + std::string(16, '[') + std::string(16, ']') + "}\"", ""},
        Published{"", "\"\"", ""}, Published{"7", "7", ""}));

TEST(Values, NoJson_IsAString) {
    Values values("e1");
    values.value("B4", "S1", "12 \xff\n", false, at(0ms));
    EXPECT_EQ(values.find("B4", "S1")->channels.at(0).json(), "\"12 \xEF\xBF\xBD\\n\"");
}

}  // namespace
}  // namespace asip::gateway
