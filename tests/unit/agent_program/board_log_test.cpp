// SPDX-License-Identifier: Apache-2.0
#include "agent/counts/board_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace asip::agent {
namespace {

using testing::HasSubstr;
using testing::Not;
using Called = std::pair<std::string, std::string>;

template <class Call>
std::string printed(Call&& call) {
    testing::internal::CaptureStderr();
    call();
    return testing::internal::GetCapturedStderr();
}

TEST(BoardLog, OneOfSeveral_EachLineNamesItOnce) {
    BoardLog log(Called{"port", "/dev/x"}, [] {});
    EXPECT_THAT(printed([&] { log.info("listening", {{"client", 1}}); }), HasSubstr("port=/dev/x client=1"));
    log.board_is("uno1");
    EXPECT_THAT(printed([&] { log.info("connected"); }), HasSubstr("board=uno1"));
    const auto line = printed([&] { log.warning("lost", {{"board", "uno1"}, {"why", "gone"}}); });
    EXPECT_EQ(line.find("board="), line.rfind("board=")) << line;
    EXPECT_THAT(line, Not(HasSubstr("port=")));
}

TEST(BoardLog, TheOnlyOne_LinesAreAsTheyWere) {
    BoardLog log(std::nullopt, [] {});
    log.board_is("uno1");
    EXPECT_THAT(printed([&] { log.info("connected", {{"broker", "b"}}); }), Not(HasSubstr("uno1")));
}

TEST(BoardLog, ForTheBus_FromInfoOnAndNotWhatPublishingLogs) {
    int news = 0;
    BoardLog* self = nullptr;
    BoardLog log(std::nullopt, [&] {
        ++news;
        self->info("published");
    });
    self = &log;
    printed([&] {
        log.debug("detail");
        log.info("one");
        log.error("two");
    });
    EXPECT_EQ(news, 2);
    std::vector<std::string> texts;
    for (const auto& line : log.take())
        texts.push_back(nlohmann::json::parse(line).at("text"));
    EXPECT_EQ(texts, (std::vector<std::string>{"one", "two"}));
}

}  // namespace
}  // namespace asip::agent
