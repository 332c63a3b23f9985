// SPDX-License-Identifier: Apache-2.0
#include "agent/safety/safe_lines.hpp"

#include <gtest/gtest.h>

namespace asip::agent {
namespace {

constexpr const char* kOff = "I,d,13,0";

struct SafeLinesTest : testing::Test {
    bool accepts_requests() const { return true; }
    Expected<session::RequestId, session::Refusal> submit(const std::string& line,
                                                          const session::RequestOptions&, Time,
                                                          session::Actions&) {
        sent.push_back(line);
        return sent.size();
    }
    void send() {
        session::Actions actions;
        lines.send(*this, Time{}, actions);
    }
    /// What was sent last ends so.
    void ends(session::Ending ending) {
        session::Finished end;
        end.id = sent.size();
        end.ending = ending;
        end.code = ending == session::Ending::kBoardError ? 11 : 0;
        EXPECT_TRUE(lines.on_finished(end, done));
        send();
    }

    SafeLines lines;
    std::vector<std::string> sent;
    std::vector<SafeLines::Done> done;
};

// truth_exhaustive, "hold and renewal": the line end of `I,d,13,0` was damaged, and the board refused what it
// read. A motor went on.
TEST_F(SafeLinesTest, RefusedOnceOrTwice_IsSentAgainUntilItIsExecuted) {
    for (const int refusals : {1, 2}) {
        sent.clear();
        done.clear();
        lines.add(kOff);
        send();
        for (int i = 0; i < refusals; ++i)
            ends(session::Ending::kBoardError);
        EXPECT_TRUE(done.empty());
        EXPECT_EQ(sent.size(), refusals + 1u);
        ends(session::Ending::kExecuted);
        ASSERT_EQ(done.size(), 1u);
        EXPECT_TRUE(done[0].executed);
        EXPECT_EQ(lines.size(), 0u);
    }
}

TEST_F(SafeLinesTest, RefusedThreeTimesInARow_IsRefused) {
    lines.add(kOff);
    send();
    ends(session::Ending::kBoardError);
    ends(session::Ending::kBoardError);
    ends(session::Ending::kTimeout);  // not in a row
    ends(session::Ending::kBoardError);
    ends(session::Ending::kBoardError);
    EXPECT_TRUE(done.empty());
    ends(session::Ending::kBoardError);
    ASSERT_EQ(done.size(), 1u);
    EXPECT_FALSE(done[0].executed);
    EXPECT_EQ(done[0].code, 11);
    EXPECT_EQ(sent.size(), 6u);
}

}  // namespace
}  // namespace asip::agent
