// SPDX-License-Identifier: Apache-2.0
// Brief answers: rows instead of objects, written and read without a JSON tree.
#include "asip/bus/registry/items.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/query.hpp"
#include "tests/unit/catalogue/bus_messages.hpp"

namespace asip::catalogue {
namespace {

using bus::BriefBoard;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

BriefBoard some_row(std::string_view board) {
    return {board, "online", 1.5, "ATmega328P", "AsipHello", "io distance", false};
}

bus::BriefRows rows_of(const std::vector<BriefBoard>& boards) {
    bus::BriefRows rows;
    for (const auto& board : boards)
        rows.add(board);
    return rows;
}

bus::Answer brief_answer(const std::vector<BriefBoard>& rows) {
    bus::Answer answer;
    answer.id = "5";
    answer.registry = "r1";
    answer.epoch = "e";
    answer.seq = 9;
    answer.settling = true;
    answer.total = 12;
    answer.cursor = "uno2//";
    answer.brief = rows_of(rows);
    return answer;
}

std::string encoded_rows(const std::vector<BriefBoard>& rows) {
    std::string text;
    bus::append_brief_rows(text, rows_of(rows));
    return text;
}

TEST(BriefAnswer, ComesBackAsItWas) {
    auto conflicting = some_row("uno2");
    conflicting.conflict = true;
    const auto answer = brief_answer({some_row("uno1"), conflicting});
    const auto text = encode(answer);
    EXPECT_THAT(text, HasSubstr(R"(["uno1","online",1.5,"ATmega328P","AsipHello","io distance"])"));
    const auto parsed = bus::parse_answer(text);
    ASSERT_TRUE(parsed) << parsed.error();
    EXPECT_EQ(*parsed, answer);
    const auto empty = bus::parse_answer(encode(brief_answer({})));
    ASSERT_TRUE(empty) << empty.error();
    EXPECT_EQ(*empty, brief_answer({}));
}

TEST(BriefAnswer, TextsOfStrangers_StayJsonAndComeBack) {
    BriefBoard row = some_row("uno1");
    row.chip = "a\"b\\c\n\x01";
    row.sketch = "Größe 😀";
    const auto read = bus::read_brief_rows(encoded_rows({row}));
    ASSERT_TRUE(read) << read.error();
    EXPECT_THAT(read->rows(), ElementsAre(row));
    row.sketch = "cut \xC3";
    const auto text = encoded_rows({row});
    ASSERT_TRUE(nlohmann::json::accept(text)) << text;
    EXPECT_EQ(bus::read_brief_rows(text)->rows().front().sketch, "cut \xEF\xBF\xBD");
}

TEST(BriefAnswer, RowsThatAreAlikeInPart_AreToldApart) {
    auto sleeping = some_row("uno3");
    sleeping.state = "sleeping";
    auto other = some_row("uno4");
    other.services = "io distance servo";
    auto escaped = some_row("uno5");
    escaped.services = "a\"b\nc and what no short string holds";
    auto fewer = some_row("uno6");
    fewer.services = "io";
    auto conflict = fewer;
    conflict.conflict = true;
    const std::vector<BriefBoard> rows{
        some_row("uno1"), some_row("uno2"), sleeping, other, other, escaped, escaped, fewer,
        conflict,         conflict,         fewer};
    const auto read = bus::read_brief_rows(encoded_rows(rows));
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->rows(), rows);
    EXPECT_EQ(encoded_rows(read->rows()), encoded_rows(rows));
    auto copy = *read;
    copy.add(some_row("uno7"));
    EXPECT_EQ(read->size(), rows.size());
    EXPECT_EQ(copy.rows().back(), some_row("uno7"));
}

TEST(BriefAnswer, AgesThatAreNone_StayJson) {
    for (const double age : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e300, -1e300, -1.0, 0.0004}) {
        BriefBoard row = some_row("uno1");
        row.age = age;
        const auto text = encoded_rows({row});
        EXPECT_TRUE(nlohmann::json::accept(text)) << text;
        EXPECT_TRUE(bus::read_brief_rows(text)) << text;
    }
}

TEST(BriefAnswer, WrittenByAnotherHand_IsRead) {
    const auto parsed = bus::parse_answer(
        R"( { "items" : [ [ "uno1" , "lost" , 2e1 , "" , "" , "" , false , {"later":[1]} ] , ["u\u006e","x",0,"","","",true] ] , )"
        R"("find":"boards", "brief" : true , "new":[[]] } )");
    ASSERT_TRUE(parsed) << parsed.error();
    ASSERT_TRUE(parsed->brief);
    EXPECT_THAT(parsed->brief->rows(), ElementsAre(BriefBoard{"uno1", "lost", 20, "", "", "", false},
                                                   BriefBoard{"un", "x", 0, "", "", "", true}));
}

TEST(BriefAnswer, RowsThatEndAlike_AreRead) {
    const auto read = bus::read_brief_rows(
        R"([["a","x",1,"c","s","v",true,{"later":[1]}],["b","y",2,"c","s","v",true,{"later":[1]}],)"
        R"(["c","x",3,"c","s","v",true],["d","x",34,"c","s","v",true] ])");
    ASSERT_TRUE(read) << read.error();
    EXPECT_THAT(read->rows(), ElementsAre(BriefBoard{"a", "x", 1, "c", "s", "v", true},
                                          BriefBoard{"b", "y", 2, "c", "s", "v", true},
                                          BriefBoard{"c", "x", 3, "c", "s", "v", true},
                                          BriefBoard{"d", "x", 34, "c", "s", "v", true}));
    EXPECT_FALSE(bus::read_brief_rows(R"([["a","x",1,"c","s","v"],["b","y",2,"c","s","v"]],[1]])"));
    EXPECT_FALSE(bus::read_brief_rows(R"([["a","x",1,"c","s","v"],["b","y",2,"c","s","v"])"));
}

TEST(BriefAnswer, ReasonOfAStateAndItsAge_AreWrittenAndRead) {
    BriefBoard lost = some_row("uno1");
    lost.state = "lost";
    lost.reason = "unplugged";
    lost.state_age = 12.5;
    BriefBoard other = lost;
    other.board = "uno2";
    other.state_age = -1;
    const auto text = encoded_rows({some_row("uno0"), lost, other, some_row("uno3")});
    EXPECT_THAT(text, testing::HasSubstr(R"(,false,"unplugged",12.5])"));
    const auto read = bus::read_brief_rows(text);
    ASSERT_TRUE(read) << read.error();
    EXPECT_THAT(read->rows(), ElementsAre(some_row("uno0"), lost, other, some_row("uno3")));
}

TEST(BriefAnswer, HostileRows_AreRefused) {
    const std::string good = R"(["a","online",1,"c","s","io"])";
    for (const std::string& rows :
         {std::string(R"({})"), std::string(R"([{}])"), std::string(R"([[]])"), std::string(R"([["a"]])"),
          std::string(R"([["a","online",1,"c","s"]])"), std::string(R"([["","online",1,"c","s","io"]])"),
          std::string(R"([[7,"online",1,"c","s","io"]])"),
          std::string(R"([["a","online","1","c","s","io"]])"),
          std::string(R"([["a","online",1,"c","s",["io"]]])"), "[" + good + good + "]", "[" + good + ",]",
          "[" + good, "[" + good + "]]", "[" + good + ",null]",
          std::string(R"([["a","online",1e,"c","s","io"]])"),
          std::string("[[\"a\",\"online\",1,\"\xFF\",\"s\",\"io\"]]"), std::string(5000, '[')}) {
        EXPECT_FALSE(bus::read_brief_rows(rows)) << rows;
        EXPECT_FALSE(bus::parse_answer(R"({"brief":true,"items":)" + rows + "}")) << rows;
    }
    EXPECT_FALSE(bus::parse_answer(R"({"brief":true})"));
    EXPECT_FALSE(bus::parse_answer(R"({"brief":true,"items":[],"items":[]})")->brief);
    EXPECT_EQ(bus::parse_answer(R"({"brief":true,"refused":"invalid","error":"why"})")->refused, "invalid");
}

TEST(BriefAnswer, CutAnywhere_IsRefused) {
    const auto text = encode(brief_answer({some_row("uno1"), some_row("uno2")}));
    for (std::size_t length = 0; length < text.size(); ++length)
        EXPECT_FALSE(bus::parse_answer(text.substr(0, length))) << length;
}

TEST(BriefQuery, OnlyForBoardsAndNotWithFull) {
    bus::Query query;
    query.brief = true;
    const auto parsed =
        bus::read_registry_request(nlohmann::json::parse(encode(bus::RegistryRequest{query, "", ""})));
    ASSERT_TRUE(parsed) << parsed.error();
    EXPECT_EQ(std::get<bus::Query>(*parsed), query);
    for (const char* bad :
         {R"({"find":"services","brief":true})", R"({"find":"boards","brief":true,"full":true})",
          R"({"find":"boards","brief":1})"}) {
        const auto refused = bus::read_registry_request(nlohmann::json::parse(bad));
        ASSERT_FALSE(refused) << bad;
        EXPECT_THAT(refused.error(), HasSubstr("brief")) << bad;
    }
}

class BriefFind : public testing::Test {
  protected:
    BriefFind() {
        for (const char* board : {"c", "a", "d", "b"})
            catalogue.apply(description(board).view(), at(0s));
        catalogue.apply(state("b", "offline").view(), at(1s));
        catalogue.apply(board_name("named").view(), at(1s));
        catalogue.apply(service_name("named", "lamp").view(), at(1s));
    }
    Catalogue catalogue;
};

TEST_F(BriefFind, SaysWhatTheWholeItemsSay) {
    for (const char* sort : {"name", "-last_seen", "state"}) {
        bus::Query query;
        query.sort = sort;
        const auto whole = catalogue.find(query, instant(at(5s)));
        query.brief = true;
        const auto brief = catalogue.find(query, instant(at(5s)));
        ASSERT_TRUE(whole && brief && brief->brief);
        const auto expected = brief_of(whole->boards);
        EXPECT_EQ(expected.size(), 5u);
        EXPECT_EQ(*brief->brief, expected) << sort;
        EXPECT_THAT(brief->boards, IsEmpty());
        EXPECT_EQ(brief->total, whole->total);
    }
}

TEST_F(BriefFind, PagesAndFilters_HoldForRowsToo) {
    bus::Query query;
    query.brief = true;
    query.limit = 2;
    query.kind = {"servo"};
    std::vector<std::string> names;
    do {
        const auto answer = catalogue.find(query, instant(at(5s)));
        ASSERT_TRUE(answer && answer->brief);
        EXPECT_LE(answer->brief->size(), 2u);
        for (const auto& row : answer->brief->rows())
            names.push_back(std::string(row.board) + " " + std::string(row.services));
        query.cursor = answer->cursor;
    } while (!query.cursor.empty() && names.size() < 10);
    EXPECT_THAT(names,
                ElementsAre("a distance servo", "b distance servo", "c distance servo", "d distance servo"));
}

TEST_F(BriefFind, NoMatch_IsStillABriefAnswer) {
    bus::Query query;
    query.brief = true;
    query.board = "nobody";
    const auto answer = catalogue.find(query, instant(at(5s)));
    ASSERT_TRUE(answer && answer->brief);
    EXPECT_TRUE(answer->brief->empty());
}

}  // namespace
}  // namespace asip::catalogue
