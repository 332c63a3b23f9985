// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "tests/unit/session/board_session_bench.hpp"

namespace asip::session {
namespace {

// A session calls no function of its caller: it returns what is to be done. So its caller may do anything
// meanwhile, but what was returned must stay whole.
struct Lifetime : testing::Test {
    Lifetime() : session(Bench::make_session(no_step_up())) {
        Actions actions;
        session->link_up({57600, false}, now, actions);
        carry_out(actions);
    }
    void carry_out(Actions& actions) {
        std::string answer;
        for (const auto& action : actions)
            if (const auto* write = std::get_if<Write>(&action))
                answer += board.hear(write->bytes, 57600, now);
        if (answer.empty()) return;
        Actions more;
        session->receive(answer, now, more);
        carry_out(more);
    }
    RequestId submit(std::string_view line, RequestOptions options, Actions& actions) {
        return session->submit(line, options, now, actions).value_or(0);
    }
    ScriptedBoard board;
    Time now{};
    std::optional<BoardSession> session;
};

TEST_F(Lifetime, SessionDroppedBetweenItsActions_TheyStayWhole) {
    ASSERT_TRUE(session->accepts_requests());
    board.mute = true;
    Actions actions;
    const auto error = submit("S,W,9,9", {.client = 7}, actions);
    const auto value = submit("D,M", {.answer_tag = 'e'}, actions);
    Actions returned;
    session->receive("~S,W,7{INVALID_DEVICE_NUMBER}\r\n@D,e,1,{42}\r\n", now, returned);
    std::string answer;
    for (const auto& action : actions)
        if (const auto* write = std::get_if<Write>(&action))
            for (std::size_t at = 0; (at = write->bytes.find("#,", at)) != std::string::npos; ++at)
                answer += '@' + write->bytes.substr(at, write->bytes.find('\n', at) - at) + "\r\n";
    session->receive(answer, now, returned);
    session.reset();
    std::map<RequestId, Finished> ends;
    int lines = 0;
    for (const auto& action : returned) {
        if (const auto* end = std::get_if<Finished>(&action)) ends[end->id] = *end;
        if (const auto* line = std::get_if<BoardLine>(&action)) lines += line->line.text().empty() ? 0 : 1;
    }
    EXPECT_EQ(lines, 2);
    EXPECT_EQ(ends.at(error).text, "INVALID_DEVICE_NUMBER");
    EXPECT_EQ(ends.at(value).answer.text(), "@D,e,1,{42}");
}

TEST_F(Lifetime, LinkGoesDownBetweenActions_EachRequestEndsOnce) {
    ASSERT_TRUE(session->accepts_requests());
    Actions actions;
    std::map<RequestId, int> ends;
    for (int i = 0; i < 40; ++i)
        submit("I,d,13,1", {.client = static_cast<ClientId>(i % 3)}, actions);
    const auto count = [&](const Actions& some) {
        for (const auto& action : some)
            if (const auto* end = std::get_if<Finished>(&action)) ++ends[end->id];
    };
    count(actions);
    std::string answer;
    for (const auto& action : actions)
        if (const auto* write = std::get_if<Write>(&action)) answer += board.hear(write->bytes, 57600, now);
    Actions returned;
    session->receive(answer, now, returned);
    // Before what is to be written is written.
    Actions down, again;
    session->link_down(now, down);
    EXPECT_FALSE(session->submit("I,d,13,1", {}, now, again).has_value());
    session->tick(now, again);
    for (const auto* some : {&returned, &down, &again})
        count(*some);
    EXPECT_EQ(ends.size(), 40u);
    for (const auto& [id, times] : ends)
        EXPECT_EQ(times, 1) << id;
}

}  // namespace
}  // namespace asip::session
