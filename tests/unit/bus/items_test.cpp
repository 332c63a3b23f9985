// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/items.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "asip/bus/json/json_text.hpp"
#include "asip/bus/registry/answer.hpp"
#include "asip/model/json.hpp"

namespace asip::bus {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

text::WallTime wall(std::int64_t milliseconds) {
    return text::WallTime(std::chrono::milliseconds(milliseconds));
}

BoardItem full_board() {
    BoardItem item;
    item.board = "uno1";
    item.state = "lost";
    item.reported = "online";
    item.names_only = true;
    item.session = "5f3a9c01";
    item.seq = 18'000'000'000'000'000'000u;
    item.lease = 60;
    item.age = 1.25;
    item.first_seen = wall(1'700'000'000'042);
    item.last_seen = wall(1'700'000'001'000);
    item.since = wall(1'700'000'000'999);
    item.chip = "ATmega328P";
    item.sketch = "a\"b\\c\n\x01 Größe \xC3";
    item.protocol = "0.4";
    item.agent = "pi asip-agent-1";
    item.link = "serial /dev/ttyACM0";
    item.labels.labels = {{"room", "lab"}, {"old", ""}};
    item.labels.services = {{"servo", "left arm"}};
    item.labels.pins = {{13, "status lamp"}};
    item.conflict = Conflict{"5f3a9c01", "77", "desk"};
    item.services = {{"uno1", "lost", "servo", "servo", "servo@1", "S", "Servos", 2, 100, "left arm"},
                     {"uno1", "lost", "x", "X", "", "", "", {}, {}, ""}};
    return item;
}

TEST(ItemText, OfABoard_IsTheTextOfItsTree) {
    BoardItem plain;
    plain.board = "a";
    for (const auto& item : {full_board(), plain, BoardItem{}}) {
        std::string text;
        append_json(text, item);
        EXPECT_EQ(json::parse(text),
                  json::parse(to_json(item).dump(-1, ' ', false, json::error_handler_t::replace)));
        EXPECT_EQ(json::parse(text).dump(), text) << "the members are not in the order of a tree's";
    }
}

TEST(ItemText, OfABoardWithItsDescription_HoldsItAsItIs) {
    auto item = full_board();
    item.description = R"({"z":1,"a":[2, 3]})";
    std::string text;
    append_json(text, item);
    EXPECT_THAT(text, HasSubstr(item.description));
    EXPECT_EQ(json::parse(text),
              json::parse(to_json(item).dump(-1, ' ', false, json::error_handler_t::replace)));
    for (const auto* broken : {"{", "[1]", R"({"a":1} )", "{\"a\":\"\xC3\"}"}) {
        item.description = broken;
        text.clear();
        append_json(text, item);
        EXPECT_TRUE(json::accept(text)) << broken;
    }
}

TEST(ItemText, OfAService_IsTheTextOfItsTree) {
    for (const auto& service : full_board().services) {
        std::string text;
        append_json(text, service);
        EXPECT_EQ(json::parse(text), to_json(service));
    }
}

TEST(ItemText, OfAChange_IsTheTextOfItsTree) {
    HistoryItem state{"uno1", wall(1'700'000'000'042), "state", "lost", "online", "lease"};
    HistoryItem command{"uno1", wall(0), "command", "", "", "\"why\""};
    command.by = "ann";
    command.service = "servo";
    command.request = R"({"write":)";
    command.status = "error";
    command.count = 2;
    for (const auto& item : {state, command, HistoryItem{}}) {
        std::string text;
        append_json(text, item);
        EXPECT_EQ(json::parse(text), to_json(item));
        EXPECT_EQ(read_history_item(json::parse(text)), item);
    }
}

TEST(ItemText, AnyText_IsWhatATreeMakesOfIt) {
    for (const char* text :
         {"", "plain", R"({"a\b":["c"]})", "\"", "\\", "\"\t\"", "\"\xC3\xA9", "\"\xFF", "\x7F"}) {
        std::string out = "before ";
        append_json_text(out, text);
        EXPECT_EQ(out, "before " + model::dump_json(text));
    }
}

TEST(ItemText, Seconds_AreCutToMilliseconds) {
    const std::vector<std::pair<double, std::string>> all{{0, "0"},
                                                          {1, "1"},
                                                          {1.25, "1.25"},
                                                          {0.0019, "0.001"},
                                                          {-1, "-1"},
                                                          {-0.5, "-0.5"},
                                                          {59.999, "59.999"},
                                                          {1e300, "1000000000000"},
                                                          {std::numeric_limits<double>::infinity(), "0"}};
    for (const auto& [seconds, expected] : all) {
        std::string text;
        append_json_seconds(text, seconds);
        EXPECT_EQ(text, expected);
    }
}

TEST(ItemText, SecondsOfAForger_AreCut) {
    const auto item =
        read_board_item(json::parse(R"({"board":"x","state":"online","age":1e308,"lease":1e308})"));
    EXPECT_EQ(item.age, kMostSeconds);
    EXPECT_EQ(item.lease, kMostSeconds);
    EXPECT_EQ(read_board_item(json::parse(R"({"board":"x","age":-1e308})")).age, -kMostSeconds);
}

}  // namespace
}  // namespace asip::bus
