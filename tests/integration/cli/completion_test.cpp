// SPDX-License-Identifier: Apache-2.0
// Names and values from the bus in the real shells of people who press Tab and Enter: nothing of them is
// executed, and the command gets the value as it is.
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/integration/cli/bus_fixture.hpp"
#include "tests/support/temp_dir.hpp"
#include "tests/support/terminal.hpp"
#include "tests/support/words.hpp"

namespace asip::test {
namespace {

namespace fs = std::filesystem;

/// CANARY is the name of a file that no program makes.
const auto kHostile = words(
    "$(touch CANARY)\n`touch CANARY`\n${x:=$(touch CANARY)}\n$((a[$(touch CANARY)]))\n"
    ";touch CANARY;\na;touch CANARY\na&touch CANARY&\na|touch CANARY\na||touch CANARY\n"
    "a&&touch CANARY\na>CANARY\n>CANARY\n>>CANARY\n<(touch CANARY)\n=(touch CANARY)\n"
    "';touch CANARY;'\n\";touch CANARY;\"\n'$(touch CANARY)'\n\"$(touch CANARY)\"\n"
    "\\$(touch CANARY)\n\\\\$(touch CANARY)\na\\\na\\\\\n(touch CANARY)\na(touch CANARY)b\n"
    "{touch,CANARY}\n$HOME\n$PATH$IFS\n*\n?[a-z]*\n/etc/*\n~root\n#no comment\n!!\n!touch\n^a^b\n"
    "%1\n--help\n-x y\na b c\n\"\n'\n''\na'b\"c`d$e\\f!g\nK\u00fcche (S\u00fcd)\n:files\na=b:c=d\n"
    "a,b\n$'\\x41'\n==ls\n",
    '\n');

struct Shell {
    const char* name;
    std::vector<std::string> command;
    const char* begin;  ///< typed first
};

void PrintTo(const Shell& shell, std::ostream* out) {
    *out << shell.name;
}

class HostileCompletion : public BusTest, public testing::WithParamInterface<Shell> {
  protected:
    HostileCompletion() {
        fs::create_directory(folder_.file("bin"));
        const auto asipctl =
            folder_.write("bin/asipctl", "#!/bin/sh\ncase $1 in __complete|completion) exec '" ASIP_PROGRAMS
                                         "/asipctl' \"$@\" ;; esac\nprintf '%s\\n' \"$@\" >'" +
                                             folder_.file("got.new") + "'\nmv '" + folder_.file("got.new") +
                                             "' '" + folder_.file("got") + "'\n");
        fs::permissions(asipctl, fs::perms::owner_all);
        announce_hostile();
        // Without it each Tab waits for one.
        EXPECT_TRUE(registry_.wait_for_errors("catalogue is complete")) << registry_.errors();
    }

    std::string hostile(std::size_t number) const {
        auto text = kHostile[number];
        for (auto at = text.find("CANARY"); at != std::string::npos; at = text.find("CANARY"))
            text.replace(at, 6, "canary");
        return text;
    }
    /// `k7-` and a number, so that Tab has one answer.
    static std::string key(std::size_t number) { return "k" + std::to_string(number) + "-"; }

    void announce_hostile() {
        constexpr std::size_t kLabelsOfABoard = 16;
        for (std::size_t from = 0; from < kHostile.size(); from += kLabelsOfABoard) {
            nlohmann::json labels;
            for (auto i = from; i < std::min(from + kLabelsOfABoard, kHostile.size()); ++i)
                labels[key(i) + "v"] = hostile(i);
            auto description = nlohmann::json::parse(cli::kUno1);
            const auto board = "board" + std::to_string(from);
            description["board"] = board;
            description["labels"] = labels;
            probe_.publish("asip/servicebus/" + board + "/$description", description.dump(), true);
            probe_.publish("asip/servicebus/" + board + "/$state", "online", true);
        }
        ASSERT_TRUE(wait_until([this] { return probe_.all_acknowledged(); }));
    }

    std::map<std::string, std::string> shell_environment() const {
        fs::create_directory(folder_.file("home"));
        return {{"PATH", folder_.file("bin") + ":" + std::getenv("PATH")},
                {"HOME", folder_.file("home")},
                {"ZDOTDIR", folder_.file("home")},
                {"ASIP_BROKER", broker_.address()}};
    }
    void begin(TerminalProcess& terminal) const {
        ASSERT_TRUE(terminal.shows("[$#%>] ?$")) << "a prompt";
        for (const auto& line : {"cd '" + folder_.file("home") + "'", std::string(GetParam().begin),
                                 std::string("asipctl sure")})
            terminal.type(line + "\r");
        ASSERT_TRUE(wait_until([&] { return got() == "sure\n"; })) << terminal.written();
    }

    std::string got() const {
        std::ifstream file(folder_.file("got"));
        return {std::istreambuf_iterator<char>(file), {}};
    }
    /// Presses Tab behind `typed`, and Enter when the line is complete. What the command got, one word a
    /// line.
    std::string press_tab_and_enter(TerminalProcess& terminal, const std::string& typed) {
        fs::remove(folder_.file("got"));
        terminal.type(typed + "\t");
        // The mark is typed behind what the shell inserts, whatever that is.
        terminal.type(" mark\r");
        if (!wait_until([&] { return fs::exists(folder_.file("got")); }, time_limit(5s))) return "nothing";
        return got();
    }

    TempDir folder_;
    ChildProcess registry_{{ASIP_PROGRAMS "/asip-registry", "--id", "r1"}, environment()};
};

TEST_P(HostileCompletion, ValueOfALabel_IsInsertedAsItIsAndNothingOfItIsExecuted) {
    TerminalProcess terminal(GetParam().command, shell_environment());
    begin(terminal);
    for (std::size_t i = 0; i < kHostile.size(); ++i) {
        const auto value = hostile(i);
        const auto whole = key(i) + "v=" + value;
        const auto words = press_tab_and_enter(terminal, "asipctl list -l " + key(i));
        EXPECT_EQ(words, "list\n-l\n" + whole + "\nmark\n") << value << "\n" << terminal.written();
        if (HasFailure()) terminal.type("\x03\r");
        EXPECT_FALSE(fs::exists(folder_.file("home/canary"))) << value;
        ASSERT_FALSE(HasFailure()) << terminal.written();
    }
    EXPECT_TRUE(fs::is_empty(folder_.file("home")) || !fs::exists(folder_.file("home/canary")));
}

TEST_P(HostileCompletion, BehindAnOpenQuote_NothingIsExecuted) {
    TerminalProcess terminal(GetParam().command, shell_environment());
    begin(terminal);
    for (std::size_t i = 0; i < kHostile.size(); ++i) {
        for (const char* quote : {"'", "\""}) {
            terminal.type("asipctl list -l " + std::string(quote) + key(i) + "\t");
            terminal.type("\r");
            terminal.type("\x03");
        }
    }
    fs::remove(folder_.file("got"));
    // What is typed ahead of a Ctrl-C may be dropped by the terminal, and an open quote may be left so.
    for (int typed = 0; typed < 10 && got() != "sure\n"; ++typed) {
        terminal.type("\x03\rasipctl sure\r");
        wait_until([&] { return got() == "sure\n"; }, time_limit(2s));
    }
    ASSERT_EQ(got(), "sure\n") << terminal.written();
    EXPECT_FALSE(fs::exists(folder_.file("home/canary")));
}

INSTANTIATE_TEST_SUITE_P(
    Shells, HostileCompletion,
    testing::Values(
        Shell{"bash", {"/usr/bin/bash", "--norc", "--noprofile", "-i"}, "source <(asipctl completion bash)"},
        Shell{"zsh",
              {"/usr/bin/zsh", "-f", "-i"},
              "autoload -U compinit; compinit -u -D; source <(asipctl completion zsh)"},
        Shell{"fish", {"/usr/bin/fish", "--no-config", "-i"}, "asipctl completion fish | source"}),
    [](const testing::TestParamInfo<Shell>& shell) { return std::string(shell.param.name); });

}  // namespace
}  // namespace asip::test
