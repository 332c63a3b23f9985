// SPDX-License-Identifier: Apache-2.0
// asipctl top on a real pseudo-terminal: what ends it, and what it says of a broker that is away.
#include <gmock/gmock.h>

#include <csignal>
#include <regex>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/terminal.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class TopTest : public BusTest {
  protected:
    void SetUp() override { announce("uno1"); }
    std::unique_ptr<TerminalProcess> top() const {
        auto utc = environment();
        utc["TZ"] = "UTC";
        auto process = std::make_unique<TerminalProcess>(program({"top", "--no-ping", "-i", "100ms"}), utc);
        EXPECT_TRUE(process->shows("uno1 +online")) << process->screen().text();
        return process;
    }
};

TEST_F(TopTest, Q_EndsIt_WithoutEnter_AndOtherKeysDoNot) {
    const auto process = top();
    process->type("x\r");
    EXPECT_EQ(process->wait_exit(std::chrono::milliseconds(500)), std::nullopt);
    process->type("q");
    EXPECT_EQ(process->wait_exit(), 0) << process->screen().text();
}

TEST_F(TopTest, Signals_EndItWhileTheTerminalTakesNoOutput) {
    for (const int signal : {SIGTERM, SIGINT}) {
        const auto process = top();
        process->type("\x13");  // Ctrl-S: whatever is written from now on waits
        EXPECT_EQ(process->wait_exit(std::chrono::milliseconds(500)), std::nullopt)
            << "it is in the middle of a line";
        ASSERT_EQ(::kill(process->pid(), signal), 0);
        EXPECT_EQ(process->wait_exit(), 128 + signal);
    }
    // Where the terminal reads, they end it in order.
    const auto process = top();
    ASSERT_EQ(::kill(process->pid(), SIGTERM), 0);
    EXPECT_EQ(process->wait_exit(), 0);
}

TEST_F(TopTest, BrokerThatIsLost_IsLostSinceThenAndOneThatNeverWasSaysNoTime) {
    {
        const auto process = top();
        const auto clock = [] {
            const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(
                std::chrono::system_clock::now().time_since_epoch());
            return seconds.count() % (24 * 3600);
        };
        const auto before = clock();
        broker_.kill();
        ASSERT_TRUE(process->shows("not known")) << process->screen().text();
        std::string text = process->screen().text();
        text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());  // the terminal folds it
        std::smatch time;
        ASSERT_TRUE(std::regex_search(text, time, std::regex("since +([0-9]{2}):([0-9]{2}):([0-9]{2})")))
            << text;
        const long said = std::stol(time[1]) * 3600 + std::stol(time[2]) * 60 + std::stol(time[3]);
        EXPECT_LE((said - before + 24 * 3600 + 1) % (24 * 3600), 120) << text << before;
        process->type("q");
        EXPECT_EQ(process->wait_exit(), 0);
    }
    for (const Words& words :
         {Words{"top", "-n", "1"}, Words{"top", "--stats", "-n", "1"}, Words{"list", "-w"}}) {
        const auto never = asipctl(words);
        EXPECT_EQ(never.status, 3) << never.errors;
        EXPECT_THAT(never.errors + never.output, Not(HasSubstr("since"))) << words.front();
    }
    broker_.start();
}

}  // namespace
}  // namespace asip::test
