// SPDX-License-Identifier: Apache-2.0
#include "asip/program/log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::program::log {
namespace {

class Log : public testing::Test {
  protected:
    template <class Write>
    std::string captured(Level level, Format format, Write write_lines) {
        configure(level, format, "asip-test");
        testing::internal::CaptureStderr();
        write_lines();
        return testing::internal::GetCapturedStderr();
    }
    ~Log() override { configure(Level::kInfo, Format::kText); }
};

TEST_F(Log, Text_IsOneLineWithQuotedFields) {
    const auto line = captured(Level::kInfo, Format::kText, [] {
        info("board online", {{"board", "uno1"}, {"baud", 500000}, {"why", "a \"b\" c"}, {"empty", ""}});
    });
    EXPECT_THAT(
        line,
        testing::MatchesRegex(
            "[0-9-]+T[0-9:.]+Z info    board online  board=uno1 baud=500000 why=\"a ..b.. c\" empty=\"\"\n"));
}

TEST_F(Log, ControlCharactersFromOutside_StayOnTheLine) {
    const auto line = captured(Level::kInfo, Format::kText,
                               [] { info("line\nbreak", {{"from", "a\r\n2026 info forged"}}); });
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
    EXPECT_THAT(line, testing::HasSubstr("\\x0a"));
}

/// As a reader of the log takes a line apart: name=value, a value in quotes up to the next quote that has
/// no backslash in front.
std::vector<std::pair<std::string, std::string>> fields_of(const std::string& line) {
    std::vector<std::pair<std::string, std::string>> fields;
    for (auto at = line.find("  ", line.find("text")) + 2; at < line.size() && line[at] != '\n';) {
        const auto equals = line.find('=', at);
        auto name = line.substr(at, equals - at);
        std::string value;
        at = equals + 1;
        const bool quoted = line[at] == '"';
        for (at += quoted ? 1 : 0; quoted ? line[at] != '"' : line[at] != ' ' && line[at] != '\n'; ++at) {
            if (quoted && line[at] == '\\' && line[at + 1] != 'x') ++at;
            value += line[at];
        }
        at += quoted ? 2 : 1;
        fields.emplace_back(std::move(name), std::move(value));
    }
    return fields;
}

TEST_F(Log, FieldsFromOutside_CannotBeMistakenForOthers) {
    for (const char* value : {"x\\\" by=\"admin", "\\", "\\\\", "a\\\" b", "\" by=admin x=\"", "a=b", "\\\"",
                              "a\\ b\\", "by=\"admin\"", "'", "x\\"}) {
        const auto line =
            captured(Level::kInfo, Format::kText, [&] { info("text", {{"first", value}, {"by", "bob"}}); });
        EXPECT_THAT(fields_of(line),
                    testing::ElementsAre(testing::Pair("first", value), testing::Pair("by", "bob")))
            << line;
    }
    const auto line = captured(Level::kInfo, Format::kText,
                               [] { info("text", {{"escape", "\x1b"}, {"written", "\\x1b"}}); });
    EXPECT_THAT(line, testing::HasSubstr("escape=\\x1b written=\"\\\\x1b\"")) << "not the same";
}

TEST_F(Log, Json_IsAnObjectALine) {
    const auto line = captured(Level::kInfo, Format::kJson, [] {
        warning("port gone", {{"port", "/dev/x"}, {"bad", "\xff\n"}, {"retry", true}});
    });
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
    const auto object = nlohmann::json::parse(line);
    EXPECT_EQ(object.at("level"), "warning");
    EXPECT_EQ(object.at("program"), "asip-test");
    EXPECT_EQ(object.at("text"), "port gone");
    EXPECT_EQ(object.at("port"), "/dev/x");
    EXPECT_EQ(object.at("retry"), "true");
}

TEST_F(Log, BelowTheLevel_IsSilent) {
    EXPECT_EQ(captured(Level::kWarning, Format::kText, [] { info("x"); }), "");
    EXPECT_EQ(captured(Level::kOff, Format::kText, [] { error("x"); }), "");
    EXPECT_NE(captured(Level::kTrace, Format::kText, [] { trace("x"); }), "");
}

TEST(LogNames, Unknown_SayWhichThereAre) {
    EXPECT_EQ(parse_level("warn"), Level::kWarning);
    EXPECT_THAT(parse_level("loud").error(), testing::HasSubstr("debug"));
    EXPECT_EQ(parse_format("json"), Format::kJson);
    EXPECT_FALSE(parse_format("xml"));
}

}  // namespace
}  // namespace asip::program::log
