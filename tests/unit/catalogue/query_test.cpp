// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/query.hpp"
#include "asip/bus/pattern.hpp"
#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/items.hpp"
#include "asip/bus/request/request_envelope.hpp"

#include <gmock/gmock.h>

namespace asip::bus {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

text::WallTime wall(std::int64_t milliseconds) {
    return text::WallTime(std::chrono::milliseconds(milliseconds));
}

BoardItem some_board(const std::string& name, const std::string& state = "online") {
    BoardItem item;
    item.board = name;
    item.state = state;
    item.reported = "online";
    item.session = "5f3a";
    item.seq = 7;
    item.lease = 60;
    item.age = 1.5;
    item.first_seen = wall(1'700'000'000'123);
    item.last_seen = wall(1'700'000'001'000);
    item.since = wall(1'700'000'000'500);
    item.chip = "ATmega328P";
    item.labels = {{{"room", "lab"}}, {{"distance", "ears"}}, {{13, "lamp"}}};
    item.conflict = Conflict{"a", "b", "pi agent"};
    ServiceItem service;
    service.board = name;
    service.state = state;
    service.name = "distance";
    service.kind = "distance";
    service.model = "distance@1";
    service.id = "D";
    service.title = "Distance \"front\"";
    service.count = 2;
    service.label = "ears";
    item.services.push_back(service);
    return item;
}

ChangeEvent change(std::uint64_t seq, ChangeEvent::Kind kind, BoardItem board) {
    ChangeEvent event;
    event.kind = kind;
    event.registry = "r1";
    event.epoch = "e";
    event.seq = seq;
    event.board = std::move(board);
    return event;
}

Answer page(std::uint64_t seq, std::vector<BoardItem> boards, std::string cursor = {}) {
    Answer answer;
    answer.registry = "r1";
    answer.epoch = "e";
    answer.seq = seq;
    answer.boards = std::move(boards);
    answer.cursor = std::move(cursor);
    return answer;
}

Expected<std::variant<Query, Forget>> read(const std::string& request) {
    return read_registry_request(nlohmann::json::parse(request));
}

TEST(QueryWire, RequestsComeBackAsTheyWere) {
    Query query;
    query.find = Find::kServices;
    query.board = "uno*";
    query.kind = {"distance", "servo"};
    query.state = {"online"};
    query.unit = "cm";
    query.capability = "pwm";
    query.sort = "-last_seen";
    query.limit = 7;
    query.cursor = "a/b/c";
    query.count = query.full = true;
    mqtt::Message message;
    message.payload = encode({query, "id", "answers/me"});
    const auto envelope = open_envelope(message);
    ASSERT_TRUE(envelope) << envelope.error().error;
    EXPECT_EQ(envelope->reply, (ReplyTo{"answers/me", "", "id"}));
    const auto parsed = read_registry_request(envelope->object);
    ASSERT_TRUE(parsed) << parsed.error();
    EXPECT_EQ(std::get<Query>(*parsed), query);
    const Forget forget{"uno1", true};
    EXPECT_EQ(std::get<Forget>(*read(encode({forget, "", ""}))), forget);
}

TEST(QueryWire, OneWordForAListIsTaken) {
    const auto parsed = read(R"({"find":"boards","state":"lost"})");
    ASSERT_TRUE(parsed);
    EXPECT_THAT(std::get<Query>(*parsed).state, ElementsAre("lost"));
}

TEST(QueryWire, BadRequests_AreRefusedByTheMemberThatIsWrong) {
    for (const auto& [text, member] :
         std::vector<std::pair<std::string, std::string>>{{R"({})", "find"},
                                                          {R"({"find":7})", "find"},
                                                          {R"({"find":"boards","kind":[1]})", "kind"},
                                                          {R"({"find":"boards","limit":0})", "limit"},
                                                          {R"({"find":"boards","limit":"x"})", "limit"},
                                                          {R"({"find":"boards","count":"yes"})", "count"},
                                                          {R"({"find":"boards","board":["a"]})", "board"},
                                                          {R"({"forget":""})", "forget"},
                                                          {R"({"forget":7})", "forget"},
                                                          {"[]", "object"}}) {
        const auto parsed = read(text);
        ASSERT_FALSE(parsed) << text;
        EXPECT_THAT(parsed.error(), HasSubstr(member)) << text;
    }
}

TEST(QueryWire, UnknownMember_IsRefusedWithTheNearestThatIsKnown) {
    for (const auto& [text, wrong, meant] : std::vector<std::tuple<std::string, std::string, std::string>>{
             {R"({"forget":"keep*","dryrun":true})", "dryrun", "dry_run"},
             {R"({"find":"boards","bord":"x"})", "bord", "board"},
             {R"({"find":"services","kinds":["distance"]})", "kinds", "kind"}}) {
        const auto parsed = read(text);
        ASSERT_FALSE(parsed) << text;
        EXPECT_THAT(parsed.error(), HasSubstr("/" + wrong + ": is unknown"));
        EXPECT_THAT(parsed.error(), HasSubstr("did you mean \"" + meant + "\"?"));
    }
    EXPECT_FALSE(read(R"({"bord":"x"})")) << "says nothing to find";
    EXPECT_FALSE(read(R"({"forget":"x","board":"y"})"));
}

TEST(QueryWire, AnswerWithoutItems_SaysWhatWasAskedFor) {
    for (const Find find : {Find::kBoards, Find::kServices, Find::kHistory, Find::kModels}) {
        Answer answer;
        answer.find = find;
        const std::string text = encode(answer);
        EXPECT_THAT(text, HasSubstr("\"find\":\"" + std::string(to_string(find)) + "\""));
        EXPECT_EQ(parse_answer(text)->find, find);
    }
}

TEST(QueryWire, AnswersAndEventsComeBackAsTheyWere) {
    Answer answer = page(9, {some_board("uno1"), some_board("uno2", "lost")}, "uno2//");
    answer.id = "5";
    answer.total = 12;
    answer.settling = true;
    const auto parsed = parse_answer(encode(answer));
    ASSERT_TRUE(parsed);
    EXPECT_EQ(*parsed, answer);

    ChangeEvent event = change(3, ChangeEvent::Kind::kState, some_board("uno1", "lost"));
    event.was = "online";
    event.reason = "lease";
    event.at = wall(1'700'000'000'001);
    const auto event_parsed = parse_change_event(encode(event));
    ASSERT_TRUE(event_parsed);
    EXPECT_EQ(*event_parsed, event);

    for (const char* bad : {"", "{}", "[]", R"({"event":"state","seq":1})", R"({"event":"what"})"}) {
        EXPECT_FALSE(parse_change_event(bad)) << bad;
        EXPECT_FALSE(parse_answer(bad)) << bad;
    }
}

TEST(QueryWire, Patterns) {
    EXPECT_TRUE(matches_pattern("", "anything"));
    EXPECT_TRUE(matches_pattern("uno*", "uno"));
    EXPECT_TRUE(matches_pattern("*1?", "uno12"));
    EXPECT_TRUE(matches_pattern("a*b*c", "aXbXbc"));
    EXPECT_FALSE(matches_pattern("uno", "uno1"));
    EXPECT_FALSE(matches_pattern("a*b", "abc"));
    EXPECT_FALSE(matches_pattern("?", ""));
    EXPECT_FALSE(matches_pattern(std::string(60, '*') + "x", std::string(2000, 'a')));
}

}  // namespace
}  // namespace asip::bus
