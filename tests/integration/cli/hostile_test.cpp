// SPDX-License-Identifier: Apache-2.0
// Odd arguments, files that are not there, and a broker that dies.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <sstream>

#include "asip/text/printable.hpp"
#include "tests/integration/cli/bus_fixture.hpp"

namespace asip::test {
namespace {

using ::testing::HasSubstr;

/// Whether each line can be written to a terminal as it is.
bool showable(const std::string& lines) {
    std::istringstream in(lines);
    for (std::string line; std::getline(in, line);)
        if (!text::is_showable(line)) return false;
    return true;
}

TEST(OddArguments, AreNamedWithoutTheirControlCharactersAndCut) {
    const auto escape = run({ASIP_PROGRAMS "/asipctl", "list", "\x1b[31mboards"});
    EXPECT_EQ(escape.status, 2);
    EXPECT_THAT(escape.errors, HasSubstr("\\x1b[31mboards"));
    EXPECT_TRUE(showable(escape.errors)) << text::printable(escape.errors, 1000);
    const auto huge = run({ASIP_PROGRAMS "/asipctl", "doctor", std::string(100'000, 'x')});
    EXPECT_EQ(huge.status, 2);
    EXPECT_LT(huge.errors.size(), 5000u);
}

TEST(OddArguments, PatternThatNoBoardCanMatch_IsRefusedBeforeAnythingIsAsked) {
    for (const char* verb : {"events", "events --logs", "events --last=1"}) {
        for (const char* pattern : {" ", "#", "+", "\x1b[31mX", "\xff", "a\n", "uno1/servo", "$state"}) {
            const std::string words = verb;
            const auto blank = words.find(' ');
            std::vector<std::string> command{ASIP_PROGRAMS "/asipctl", words.substr(0, blank), pattern,
                                             "--broker", "127.0.0.1:1"};
            if (blank != std::string::npos) command.push_back(words.substr(blank + 1));
            const auto refused = run(command);
            EXPECT_EQ(refused.status, 2) << verb << " " << text::printable(pattern) << refused.errors;
            EXPECT_TRUE(showable(refused.errors)) << verb;
        }
    }
}

TEST_F(BusTest, StandardFilesThatAreClosed_AreNoConnection) {
    const std::string programs = ASIP_PROGRAMS;
    for (const Words& words : std::vector<Words>{{"asipctl", "events", "--logs"},
                                                 {"asip-registry", "--id", "r1"},
                                                 {"asip-agent", "--tcp", "127.0.0.1:1", "--name", "uno1"}}) {
        const auto& program = words.front();
        auto command = "exec " + programs;
        for (const auto& word : words)
            command += (&word == &program ? "/" : " ") + word;
        ChildProcess process({"bash", "-c", command + " <&- >&- 2>&-"}, environment());
        const auto folder = std::filesystem::path("/proc") / std::to_string(process.pid());
        ASSERT_TRUE(wait_until([&] {
            std::error_code error;
            return std::filesystem::read_symlink(folder / "exe", error).filename() == program &&
                   std::filesystem::exists(std::filesystem::symlink_status(folder / "fd" / "5", error));
        })) << program;
        for (const char* file : {"0", "1", "2"})
            EXPECT_EQ(std::filesystem::read_symlink(folder / "fd" / file), "/dev/null")
                << program << " " << file;
    }
    announce("uno1");
    const auto closed =
        run({"bash", "-c", "exec " ASIP_PROGRAMS "/asipctl list --from-bus >&-"}, environment());
    EXPECT_EQ(closed.status, 1);
    EXPECT_THAT(closed.errors, HasSubstr("cannot write the output"));
}

TEST_F(BusTest, TerminalThatKnowsNoEscapes_GetsNone) {
    announce("uno1");
    for (const char* term : {"dumb", ""}) {
        auto variables = environment();
        variables["TERM"] = term;
        // `script` gives it a terminal and passes on what it writes there.
        for (const std::string command : {"list --from-bus", "show uno1"}) {
            const auto shown =
                run({"script", "-qefc", ASIP_PROGRAMS "/asipctl " + command, "/dev/null"}, variables);
            EXPECT_EQ(shown.status, 0) << shown.errors;
            EXPECT_THAT(shown.output, HasSubstr("uno1")) << command;
            EXPECT_EQ(shown.output.find('\x1b'), std::string::npos)
                << command << ": " << text::printable(shown.output, 1000);
        }
    }
}

TEST_F(BusTest, TerminalThatIsClosed_EndsInOrderWhateverRuns) {
    announce("uno1");
    for (const Words& words : {Words{"subscribe", "uno1", "--changes"}, Words{"events", "--logs", "uno1"}}) {
        ChildProcess child(program(words), environment());
        ASSERT_TRUE(wait_until([&] {
            probe_.publish("asip/uno1/distance/out", R"({"distance":[4711]})");
            probe_.publish("asip/uno1/out", "!4711");
            return child.output().find("4711") != std::string::npos;
        })) << words.front();
        child.signal(SIGHUP);
        child.signal(SIGHUP);  // kernel and shell send one each
        EXPECT_EQ(child.wait_exit(), 0) << words.front() << child.errors();
    }
}

TEST_F(BusTest, BrokerKilledMeanwhile_WhatFollowsGoesOnWhenItIsBack) {
    announce("uno1");
    ChildProcess subscribe(program({"subscribe", "uno1/distance"}), environment());
    ChildProcess logs(program({"events", "--logs", "uno1"}), environment());
    ChildProcess ping(program({"ping", "uno1", "-n", "0", "--timeout", "1s"}), environment());
    ASSERT_TRUE(probe_.wait_for("asip/uno1/in"));
    const auto say = [this](const std::string& value) {
        probe_.publish("asip/uno1/distance/out", R"({"distance":[)" + value + "]}");
        probe_.publish("asip/uno1/out", "!" + value);
        probe_.publish("asip/uno1/X/out", R"({"tag":"k","body":")" + value + "\"}");
    };
    const auto all_hear = [&](const std::string& value) {
        return wait_until([&] {
            say(value);
            return subscribe.output().find(value) != std::string::npos &&
                   logs.output().find(value) != std::string::npos;
        });
    };
    ASSERT_TRUE(all_hear("4711")) << subscribe.errors() << logs.errors();
    broker_.kill();
    broker_.start();
    ASSERT_TRUE(wait_until([&] { return probe_.connected(); }));
    EXPECT_TRUE(all_hear("4712")) << subscribe.errors() << logs.errors();
    for (auto* each : {&subscribe, &logs, &ping})
        EXPECT_TRUE(each->wait_for_errors("closed the connection") &&
                    each->wait_for_errors("connected again"))
            << each->errors();
}

}  // namespace
}  // namespace asip::test
