// SPDX-License-Identifier: Apache-2.0
// What receivers of notices answer, good and bad, in pieces of any size.
#include "registry/webhook_answer.hpp"

#include <gmock/gmock.h>

namespace asip::registry {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using ::testing::HasSubstr;
using ::testing::Not;
using Verdict = WebhookAnswer::Verdict;

const auto kNow = std::chrono::system_clock::from_time_t(1'792'567'650);  // Wed, 21 Oct 2026 07:27:30 GMT

std::optional<Verdict> verdict_of(std::string_view text, const std::string& asked = "http://pi/topic") {
    std::optional<Verdict> first;
    for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{4096}}) {
        WebhookAnswer answer;
        for (auto rest = text; !rest.empty() && !answer.complete();
             rest.remove_prefix(std::min(size, rest.size())))
            answer.add(rest.substr(0, size));
        const auto verdict = answer.verdict(parse_webhook(asked).value(), kNow);
        if (size == 1) first = verdict;
        EXPECT_EQ(verdict.has_value(), first.has_value()) << text;
        EXPECT_EQ(verdict.value_or(Verdict{}).why, first.value_or(Verdict{}).why) << text;
    }
    return first;
}

WebhookResult result_of(std::string_view text) {
    const auto verdict = verdict_of(text);
    EXPECT_TRUE(verdict) << text;
    return verdict ? verdict->result : WebhookResult::kFailed;
}

TEST(WebhookAnswer, StatusThatCounts_IsTheLastAndItsLinesEndAnyhow) {
    for (const std::string_view good :
         {"HTTP/1.1 200 OK\r\n\r\n", "HTTP/1.0 204\r\n\r\n", "HTTP/1.1 200 OK\n\n",
          "HTTP/1.1 202\r\nX: y\n\r\n", "HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 200 OK\r\n\r\n",
          "HTTP/1.1 103 Early Hints\r\nLink: </a>\r\n\r\nHTTP/1.1 102 Processing\n\nHTTP/1.1 201 "
          "Made\r\n\r\n",
          "HTTP/1.1 200 OK\r\n", "HTTP/1.1 200 OK", "HTTP/1.1 200 OK\r\nContent-Le"})
        EXPECT_EQ(result_of(good), WebhookResult::kDelivered) << good;
    for (const std::string_view refused :
         {"HTTP/1.1 404\n\n", "HTTP/1.1 301 Moved\r\n\r\n", "HTTP/1.1 400 No\r\n"})
        EXPECT_EQ(result_of(refused), WebhookResult::kRefused) << refused;
    for (const std::string_view later : {"HTTP/1.1 500\r\n\r\n", "HTTP/1.1 429\n\n", "HTTP/1.1 000\r\n\r\n"})
        EXPECT_EQ(result_of(later), WebhookResult::kFailed) << later;
}

TEST(WebhookAnswer, NoAnswer_IsNoneAndGarbageIsToldAtOnce) {
    EXPECT_FALSE(verdict_of(""));
    EXPECT_FALSE(verdict_of("HTTP/1.1 100 Continue\r\n\r\n"));
    for (const std::string_view bad :
         {"SSH-2.0-OpenSSH_9.2\r\n", "\x15\x03\x01", "HTTP/2 200\r\n\r\n", "HTTP/1.1 abc\r\n\r\n",
          "HTTP/1.1\r\n\r\n", "\r\nHTTP/1.1 200 OK\r\n\r\n"}) {
        const auto verdict = verdict_of(bad);
        ASSERT_TRUE(verdict) << bad;
        EXPECT_EQ(verdict->result, WebhookResult::kFailed);
        EXPECT_EQ(verdict->why, "what answers there does not speak HTTP") << bad;
    }
    WebhookAnswer endless;
    for (int i = 0; i < 100 && !endless.complete(); ++i)
        endless.add(i == 0 ? "HTTP/1.1 204 No\r\nX: " : std::string(1000, 'x'));
    EXPECT_TRUE(endless.complete());
    EXPECT_EQ(endless.verdict(parse_webhook("http://pi/").value(), kNow)->result, WebhookResult::kDelivered);
}

TEST(WebhookAnswer, RetryAfter_IsSecondsOrATimeAndAtMostAnHour) {
    const auto wait = [](const std::string& value, const char* status = "429") {
        return verdict_of("HTTP/1.1 " + std::string(status) + " Later\r\nretry-AFTER:\t" + value + "\r\n\r\n")
            ->wait;
    };
    EXPECT_EQ(wait("4"), seconds(4));
    EXPECT_EQ(wait("7", "503"), seconds(7));
    EXPECT_EQ(wait("Wed, 21 Oct 2026 07:28:00 GMT"), seconds(30));
    for (const char* longer : {"3601", "99999999999999999999999", "Wed, 21 Oct 2099 07:28:00 GMT"})
        EXPECT_EQ(wait(longer), hours(1)) << longer;
    for (const char* none : {"", "0", "-5", "soon", "Wed, 21 Oct 2020 07:28:00 GMT", "Wed, 99 Okt"})
        EXPECT_EQ(wait(none), seconds(0)) << none;
    EXPECT_EQ(wait("9", "404"), seconds(0)) << "that one is not tried again";
}

TEST(WebhookAnswer, Words_AreShortWholeAndWithoutSecrets) {
    const auto why = [](const std::string& words, const std::string& heads = "",
                        const std::string& asked =
                            "https://ann:p%2Fs:s@pi/hooks/T0KEN%20x/?key=h1dden&to=all") {
        return verdict_of("HTTP/1.1 403 No\r\n" + heads + "\r\n" + words, asked)->why;
    };
    EXPECT_EQ(why("go away\n"), "it answered with status 403: go away");
    EXPECT_EQ(why(""), "it answered with status 403");
    EXPECT_EQ(why("\r\n \n"), "it answered with status 403");
    EXPECT_EQ(why("7\r\ngo away\r\n0\r\n\r\n", "Transfer-Encoding: Chunked\r\n").substr(0, 36),
              "it answered with status 403: go away");
    const std::string long_word = std::string(199, 'a') + "\xc3\xa4 and more of it";
    EXPECT_EQ(why(long_word), "it answered with status 403: " + std::string(199, 'a'));
    for (const char* echo :
         {"Cannot POST /hooks/T0KEN%20x/?key=h1dden&to=all", "no hook T0KEN x", "bad key: h1dden",
          "no user ann:p/s:s", "you sent Basic YW5uOnAvczpz", "{\"path\":\"\\/hooks\\/T0KEN%20x\"}",
          "<b>/hooks/T0KEN%20x/?key=h1dden&amp;to=all</b>"})
        EXPECT_THAT(why(echo), Not(::testing::AnyOf(HasSubstr("T0KEN"), HasSubstr("h1dden"),
                                                    HasSubstr("p/s:s"), HasSubstr("YW5uOnAvczpz"))))
            << echo;
    EXPECT_THAT(why(std::string(195, 'a') + " h1dden"), ::testing::EndsWith("aaa ..."));
    EXPECT_EQ(
        verdict_of("HTTP/1.1 302 Found\r\nLocation: https://ann:p@new.example/other?key=new\r\n\r\n")->why,
        "it answered with status 302, another address, at https://new.example");
}

TEST(WebhookAnswer, OneThatIsNotReadToItsEnd_HasItsVerdict) {
    WebhookAnswer answer;
    answer.add("HTTP/1.1 410 Gone\r\nContent-Length: 100\r\n\r\nmoved away");
    EXPECT_FALSE(answer.complete());
    EXPECT_EQ(answer.verdict(parse_webhook("http://pi/").value(), kNow)->why,
              "it answered with status 410: moved away");
}

}  // namespace
}  // namespace asip::registry
