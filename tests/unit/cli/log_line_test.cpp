// SPDX-License-Identifier: Apache-2.0
#include "cli/events/log_line.hpp"

#include <gtest/gtest.h>

namespace asip::cli {
namespace {

std::string shown(const std::string& topic, const std::string& payload, bool retained = false) {
    mqtt::Message message{.topic = topic, .payload = payload, .retain = retained};
    const auto line = log_line(bus::Topics{}, message);
    return line ? line->board + "|" + line->source + "|" + line->level + "|" + line->text : "-";
}

TEST(LogLine, LineOfASketch_IsShownWithoutItsMark) {
    EXPECT_EQ(shown("asip/uno1/out", "!low battery"), "uno1|board|info|low battery");
    EXPECT_EQ(shown("asip/uno1/out", "!low battery\r\n"), "uno1|board|info|low battery");
    EXPECT_EQ(shown("asip/uno1/out", "@D,e,1,{42}"), "-");
    EXPECT_EQ(shown("asip/uno1/out", "~S,W,7{X}"), "-") << "the error topic has it, decoded";
}

TEST(LogLine, Errors_AreOfTheirService) {
    EXPECT_EQ(shown("asip/uno1/servo/error", R"({"request":"W","code":7,"error":"INVALID_DEVICE_NUMBER"})"),
              "uno1|servo|error|W: INVALID_DEVICE_NUMBER (7)");
    EXPECT_EQ(
        shown("asip/uno1/servo/error", R"({"request":"W,0,90","reason":"queue-full","error":"too many"})"),
        "uno1|servo|error|W,0,90: queue-full, too many");
}

TEST(LogLine, LineOfAnAgent_HasItsFieldsBehindTheText) {
    EXPECT_EQ(
        shown("asip/servicebus/uno1/$log",
              R"({"time":"2026-11-21T19:00:00.000Z","level":"warning","text":"board lost","why":"gone"})"),
        "uno1|agent|warning|board lost  why=gone");
}

TEST(LogLine, WhatIsNoReport_IsNotShown) {
    EXPECT_EQ(shown("asip/servicebus/uno1/$state", "online"), "-");
    EXPECT_EQ(shown("asip/uno1/servo/out", "{}"), "-");
    for (const char* payload : {"", "{", "[]", "7", "null"})
        EXPECT_EQ(shown("asip/servicebus/uno1/$log", payload), "-") << payload;
    EXPECT_EQ(shown("asip/servicebus/uno1/$log", R"({"text":7,"level":[]})"), "uno1|agent|[]|7");
    EXPECT_EQ(shown("asip/servicebus/uno1/$log", R"({"text":"old"})", true), "-") << "retained by somebody";
}

}  // namespace
}  // namespace asip::cli
