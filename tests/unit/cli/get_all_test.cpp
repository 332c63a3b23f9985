// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/get_all.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asip/model/model_set.hpp"

namespace asip::cli {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

std::vector<std::string> shown(const ServiceValues& values, const std::string& kind) {
    model::Description board;
    board.board = "uno1";
    board.labels.pins = {{13, "status lamp"}, {14, "light"}};
    board.pins.analog = {{14, 0}, {15, 1}};
    std::vector<std::string> lines;
    for (const auto& row : values.rows(board, kind, model::ModelSet::standard().find(kind).get()))
        lines.push_back(row.what + "=" + row.text + " " + row.how);
    return lines;
}

TEST(AllValuesOfAService, NumbersHaveUnits) {
    ServiceValues values;
    values.take(json::parse(R"({"distance":[42,118]})"), "asked", {});
    EXPECT_THAT(shown(values, "distance"), ElementsAre("distance 0=42 cm asked", "distance 1=118 cm asked"));
}

TEST(AllValuesOfAService, PinsGoByNameAndLevel_AndPartsComeTogether) {
    ServiceValues values;
    values.take(json::parse(R"({"digital":{"2":1}})"), "reported", {});
    values.take(json::parse(R"({"digital":{"13":0}})"), "reported", {});
    values.take(json::parse(R"({"analog":{"0":320}})"), "reported", {});
    values.take(json::parse(R"({"modes":[1,2]})"), "reported", {});
    values.set(json::parse(R"({"write":{"13":1},"report":100})"));
    EXPECT_THAT(shown(values, "io"),
                ElementsAre("A0 light=320 reported", "pin 13 status lamp=low reported", "pin 2=high reported",
                            "report=100 ms set", "write pin 13 status lamp=high set"));
}

TEST(AllValuesOfAService, WhatAnybodyMayPublish_DoesNoHarmAndIsBounded) {
    ServiceValues values;
    for (const char* text :
         {"7", "[]", R"({"digital":7})", R"({"digital":{"x":{}}})", R"({"distance":null})"})
        values.take(json::parse(text), "reported", {});
    for (int i = 0; i < 1000; ++i)
        values.take({{"event" + std::to_string(i), i}}, "reported", {});
    values.set(7);
    EXPECT_LE(shown(values, "io").size(), 20u);
    EXPECT_FALSE(shown(values, "distance").empty());
}

}  // namespace
}  // namespace asip::cli
