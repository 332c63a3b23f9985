// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "catalogue_bench.hpp"
#include "tests/support/catalogue_check.hpp"

namespace asip::catalogue {
namespace {

using testing::IsEmpty;

using Kind = Event::Kind;

struct Bad {
    const char* name;
    OwnedMessage message;
    Refusal refusal;
};

class BadMessageTest : public testing::TestWithParam<Bad> {};

TEST_P(BadMessageTest, IsRefusedWithItsReason_ChangesNothing_AndTheNextGoodOneWorks) {
    Catalogue catalogue;
    catalogue.apply(description("uno1").view(), at(0s));
    const std::string before = CatalogueCheck::fingerprint(catalogue);
    const auto applied = catalogue.apply(GetParam().message.view(), at(1s));
    EXPECT_EQ(applied.refused, GetParam().refusal);
    EXPECT_THAT(applied.events, IsEmpty());
    EXPECT_EQ(CatalogueCheck::fingerprint(catalogue), before);
    EXPECT_EQ(CatalogueCheck::check(catalogue), "");
    EXPECT_EQ(catalogue.stats().refused[static_cast<std::size_t>(GetParam().refusal)], 1u);
    EXPECT_FALSE(catalogue.apply(description("uno1", {.seq = 2}).view(), at(2s)).refused);
    EXPECT_FALSE(catalogue.apply(description("uno2").view(), at(2s)).refused);
}

OwnedMessage raw_description(const std::string& payload, const std::string& board = "uno1") {
    return {bus::TopicKind::kDescription, board, payload};
}
OwnedMessage with_services(const std::string& services) {
    return description("uno1", {.seq = 2, .services = services});
}

INSTANTIATE_TEST_SUITE_P(
    Each, BadMessageTest,
    testing::Values(
        Bad{"NoJson", raw_description("hello"), Refusal::kMalformed},
        Bad{"CutOff", raw_description(R"({"board":"uno1","session":"a","seq":2,"services":[)"),
            Refusal::kMalformed},
        Bad{"TrailingBytes", raw_description(R"({"board":"uno1","session":"a","seq":2,"services":[]} x)"),
            Refusal::kMalformed},
        Bad{"NoServices", raw_description(R"({"board":"uno1","session":"a","seq":2})"), Refusal::kMalformed},
        Bad{"NegativeSeq", raw_description(R"({"board":"uno1","session":"a","seq":-2,"services":[]})"),
            Refusal::kMalformed},
        Bad{"FractionalSeq", raw_description(R"({"board":"uno1","session":"a","seq":2.5,"services":[]})"),
            Refusal::kMalformed},
        Bad{"HugeSeq",
            raw_description(R"({"board":"uno1","session":"a","seq":99999999999999999999,"services":[]})"),
            Refusal::kMalformed},
        Bad{"EmptySession", raw_description(R"({"board":"uno1","session":"","seq":2,"services":[]})"),
            Refusal::kMalformed},
        Bad{"BoardTwice",
            raw_description(R"({"board":"uno1","board":"uno1","session":"a","seq":2,"services":[]})"),
            Refusal::kMalformed},
        Bad{"NoUtf8",
            raw_description(
                "{\"board\":\"uno1\",\"session\":\"a\",\"seq\":2,\"services\":[],\"x\":\"\xff\"}"),
            Refusal::kMalformed},
        Bad{"TooDeep",
            raw_description(R"({"board":"uno1","session":"a","seq":2,"services":[],"x":)" +
                            std::string(5000, '[') + std::string(5000, ']') + "}"),
            Refusal::kMalformed},
        Bad{"TooLong", raw_description(std::string(65 * 1024, ' ')), Refusal::kTooLong},
        Bad{"OtherBoard", raw_description(R"({"board":"uno2","session":"a","seq":2,"services":[]})"),
            Refusal::kWrongBoard},
        Bad{"ReservedName",
            raw_description(R"({"board":"registry","session":"a","seq":2,"services":[]})", "registry"),
            Refusal::kBadName},
        Bad{"ServicesNoList", with_services("{}"), Refusal::kMalformed},
        Bad{"ServiceNoObject", with_services("[1]"), Refusal::kMalformed},
        Bad{"ServiceWithoutName", with_services(R"([{"id":"D"}])"), Refusal::kMalformed},
        Bad{"ServiceWithInvalidName", with_services(R"([{"name":"a/b"}])"), Refusal::kMalformed},
        Bad{"ServiceTwice", with_services(R"([{"name":"a"},{"name":"a"}])"), Refusal::kMalformed},
        Bad{"ServiceWithLongId", with_services(R"([{"name":"a","id":"DD"}])"), Refusal::kMalformed},
        Bad{"ServiceWithInvalidModel", with_services(R"([{"name":"a","model":"a b@1"}])"),
            Refusal::kMalformed},
        Bad{"ServiceWithNegativeCount", with_services(R"([{"name":"a","count":-1}])"), Refusal::kMalformed},
        Bad{"SaidStateNoObject", description("uno1", {.seq = 2, .more = R"("state":"lost")"}),
            Refusal::kMalformed},
        Bad{"UnknownState", state("uno1", "dead"), Refusal::kBadState},
        Bad{"StateOfInvalidName", state("a b", "online"), Refusal::kBadName},
        Bad{"EmptyBoardName", board_name(""), Refusal::kBadName},
        Bad{"BoardNameWithSlash", board_name("a/b"), Refusal::kBadName},
        Bad{"BoardNameReserved", board_name("servicebus"), Refusal::kBadName},
        Bad{"LongBoardName", board_name(std::string(65, 'a')), Refusal::kBadName},
        Bad{"ServiceNameInvalid", service_name("uno1", "a+b"), Refusal::kBadName}),
    [](const auto& param) { return param.param.name; });

TEST_F(CatalogueTest, TooManyServices_AreRefused) {
    std::string services = "[";
    for (int i = 0; i < 65; ++i)
        services += (i > 0 ? "," : "") + (R"({"name":"s)" + std::to_string(i) + "\"}");
    give(description("uno1", {.services = services + "]"}));
    EXPECT_EQ(refused, Refusal::kMalformed);
    for (int i = 0; i < 64; ++i)
        give(service_name("esp1", "s" + std::to_string(i)));
    EXPECT_EQ(refused, std::nullopt);
    give(service_name("esp1", "s64"));
    EXPECT_EQ(refused, Refusal::kTooMany);
}

TEST_F(CatalogueTest, UnknownMembersAndOwnModels_AreKeptInTheFullDescription) {
    const std::string payload =
        R"({"x-note":"hi \"there\"","x\":1,\"seq":5,"board":"uno1","session":"a","seq":1,"services":[{"name":"foo","id":"F",)"
        R"("model":{"name":"foo","events":{"e":{"fields":[{"name":"v","unit":"lux"}]}}}}]})";
    give(raw_description(payload));
    bus::Query query;
    query.full = true;
    const auto answer = catalogue.find(query, instant(at(0s)));
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->boards.size(), 1u);
    EXPECT_THAT(answer->boards[0].description, testing::HasSubstr(R"("x-note":"hi \"there\"")"));
    EXPECT_THAT(answer->boards[0].description, testing::HasSubstr(R"("x\":1,\"seq":5)"));
    EXPECT_THAT(answer->boards[0].description, testing::HasSubstr(R"("unit":"lux")"));
    EXPECT_EQ(answer->boards[0].services[0].kind, "foo");
}

}  // namespace
}  // namespace asip::catalogue
