// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/unit/agent/online_bridge.hpp"

namespace asip::agent {
namespace {

using session::Ending;

/// A point-to-point client with a session of its own.
class Client {
  public:
    Client(BridgeBench& bench, session::ClientId id)
        : bench_(bench), id_(id), session_(session::Bench::make_session({}, id)) {
        session::Actions actions;
        session_.link_up({}, bench_.now, actions);
        perform(actions);
    }
    session::RequestId request(const std::string& line) {
        session::Actions actions;
        const auto id = session_.submit(line, {}, bench_.now, actions);
        perform(actions);
        return id.value_or(0);
    }
    void take(const std::string& line) {
        session::Actions actions;
        session_.receive(line + '\n', bench_.now, actions);
        perform(actions);
    }
    void tick() {
        session::Actions actions;
        session_.tick(bench_.now, actions);
        perform(actions);
    }
    session::ClientId id() const { return id_; }
    bool ready() const { return session_.accepts_requests(); }
    std::map<session::RequestId, Ending> ends;
    std::string to_send;

  private:
    void perform(session::Actions& actions) {
        for (const auto& action : actions) {
            if (const auto* write = std::get_if<session::Write>(&action)) to_send += write->bytes;
            if (const auto* end = std::get_if<session::Finished>(&action)) ends[end->id] = end->ending;
        }
    }
    BridgeBench& bench_;
    session::ClientId id_;
    session::BoardSession session_;
};

struct SessionsAtOnePort : testing::TestWithParam<bool> {
    SessionsAtOnePort() {
        bench.board.verified_fences = GetParam();
        bench.board.replies["S,W,9,9"] = "~S,W,7{INVALID_DEVICE_NUMBER}";
        bench.go_online();
        pass(1s);
    }
    void exchange() {
        for (bool more = true; more;) {
            more = false;
            for (Client* client : {&one, &two}) {
                std::string bytes = std::exchange(client->to_send, {});
                for (std::size_t end; (end = bytes.find('\n')) != std::string::npos;
                     bytes.erase(0, end + 1)) {
                    bench.client_says(bytes.substr(0, end), client->id());
                    more = true;
                }
            }
            for (const auto& line : std::exchange(bench.lines_for_one, {}))
                for (Client* client : {&one, &two})
                    if (line.client == client->id()) client->take(line.line), more = true;
            for (const auto& line : std::exchange(bench.client_lines, {}))
                for (Client* client : {&one, &two})
                    client->take(line), more = true;
        }
    }
    void pass(Duration time) {
        for (const Time end = bench.now + time; bench.now < end;) {
            exchange();
            bench.pass(5ms);
            one.tick();
            two.tick();
        }
        exchange();
    }
    BridgeBench bench;
    Client one{bench, 1}, two{bench, 2};
};
INSTANTIATE_TEST_SUITE_P(Boards, SessionsAtOnePort, testing::Bool(),
                         [](const auto& verified) { return verified.param ? "Verified" : "Echo"; });

TEST_P(SessionsAtOnePort, OneSendsWhatIsRefused_EachGetsItsOwnOutcomes) {
    ASSERT_TRUE(one.ready() && two.ready());
    for (int i = 0; i < 200; ++i) {
        const auto good = one.request("I,d,13,1");
        const auto bad = two.request("S,W,9,9");
        pass(50ms);
        ASSERT_TRUE(one.ends.contains(good)) << i;
        EXPECT_EQ(one.ends[good], Ending::kExecuted) << i;
        ASSERT_TRUE(two.ends.contains(bad)) << i;
        EXPECT_EQ(two.ends[bad], Ending::kBoardError) << i;
    }
}

TEST_P(SessionsAtOnePort, PlainLinesOfTwoLookAlike_AnErrorGoesToItsOwnAlone) {
    constexpr session::ClientId kGood = 3, kBad = 4;
    bench.lines_for_one.clear();
    bench.client_lines.clear();
    for (int i = 0; i < 20; ++i) {
        bench.client_says("S,W,0,9", kGood);
        bench.client_says("S,W,9,9", kBad);
        bench.client_says("S,W,1,9", kGood);
        bench.pass(300ms);
    }
    EXPECT_THAT(bench.client_lines, testing::IsEmpty()) << "nothing to all";
    EXPECT_EQ(bench.lines_for_one.size(), 20u);
    for (const auto& line : bench.lines_for_one) {
        EXPECT_EQ(line.client, kBad);
        EXPECT_EQ(line.line, "~S,W,7{INVALID_DEVICE_NUMBER}");
    }
}

TEST_P(SessionsAtOnePort, LineBetweenAgentAndBoardChangesARequest_IsNeverOkWhereTheBoardVerifies) {
    if (!GetParam()) GTEST_SKIP() << "nothing shows that on such a board";
    ASSERT_TRUE(one.ready() && two.ready());
    bench.board.misreads["I,d,13,1"] = "I,d,13,0";
    const auto changed = one.request("I,d,13,1");
    const auto other = two.request("I,d,12,1");
    pass(8s);
    ASSERT_TRUE(one.ends.contains(changed));
    EXPECT_NE(one.ends[changed], Ending::kExecuted);
    EXPECT_TRUE(two.ends.contains(other));
    const auto next = one.request("I,d,12,0");
    pass(200ms);
    ASSERT_TRUE(one.ends.contains(next));
    EXPECT_EQ(one.ends[next], Ending::kExecuted);
}

TEST_P(SessionsAtOnePort, AnswerOfTheBoardIsDamaged_IsNotTakenForExecuted) {
    ASSERT_TRUE(one.ready() && two.ready());
    bench.board.replies["S,W,0,5"] = "~S,W,7INVALID_DEVICE";
    const auto id = one.request("S,W,0,5");
    pass(8s);
    ASSERT_TRUE(one.ends.contains(id));
    EXPECT_NE(one.ends[id], Ending::kExecuted);
}

}  // namespace
}  // namespace asip::agent
