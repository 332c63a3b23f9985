// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/shell.hpp"

#include <unistd.h>

#include <istream>
#include <ostream>

#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"
#include "cli/shell/interactive_shell.hpp"
#include "cli/shell/run_self.hpp"
#include "cli/shell/shell_words.hpp"

namespace asip::cli {
namespace {

/// One line, of which no more than the shell takes is kept; its end is `\n`, `\r` or both. False: the input
/// has ended. `last`: the character before, which the next call is to be given.
bool read_line(std::istream& in, std::string& line, int& last) {
    line.clear();
    for (int c = in.get(); c != std::istream::traits_type::eof(); c = in.get()) {
        const bool second = c == '\n' && last == '\r';
        last = c;
        if (second) continue;
        if (c == '\n' || c == '\r') return true;
        if (line.size() <= kMaxShellLine) line += static_cast<char>(c);
    }
    return !line.empty();
}

/// Each line of the input, in order; the status of the first that failed.
class ScriptShell {
  public:
    ScriptShell(Environment& environment, std::string board)
        : environment_(environment), board_(std::move(board)) {}

    int run() {
        std::string line;
        int last = 0;
        for (std::size_t number = 1;
             !ended_ && !environment_.output_ended() && read_line(environment_.in, line, last); ++number) {
            const auto status = run_line(line);
            if (status && *status == program::kExitOk) continue;
            const int failed = status ? *status : program::kExitUsage;
            environment_.note("line " + std::to_string(number) + ": " +
                              (status ? "ended with status " + std::to_string(failed) : status.error()));
            if (first_failed_ == program::kExitOk) first_failed_ = failed;
        }
        return first_failed_;
    }

  private:
    Expected<int> run_line(const std::string& line) {
        const auto words = shell_words(line);
        if (!words) return fail(words.error());
        if (words->empty() || words->front().starts_with("#")) return program::kExitOk;
        const auto& first = words->front();
        ended_ = first == "exit" || first == "quit";
        if (ended_ || first == "values") return program::kExitOk;
        if (first == "shell") return fail("this is a shell already");
        if (*words == std::vector<std::string>{"help"}) {
            environment_.out << shell_help(board_) << std::flush;
            return program::kExitOk;
        }
        environment_.out.flush();
        return run_self(
            {arguments_for(environment_, expand_words(*environment_.command_line, *words, board_))});
    }

    Environment& environment_;
    std::string board_;
    bool ended_ = false;
    int first_failed_ = program::kExitOk;
};

/// With a connection of its own: each line makes another one.
Outcome<void> find_board(Environment& environment, const std::string& board) {
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return tl::unexpected(connected.error());
    if (const auto known = source.board(board); !known) return tl::unexpected(known.error());
    return {};
}

}  // namespace

int run_shell(const ShellOptions& options, Environment& environment) {
    const auto target = parse_target(options.board);
    if (!target) return environment.fail_with(target.error());
    if (!target->service.empty())
        return environment.fail_with(
            {program::kExitUsage, "name the board alone: asipctl shell " + target->board});
    if (!environment.terminal() || isatty(STDIN_FILENO) == 0) {
        if (const auto known = find_board(environment, target->board); !known)
            return environment.fail_with(known.error());
        return ScriptShell(environment, target->board).run();
    }
    return InteractiveShell(environment, target->board, options.values == "on").run();
}

namespace {

Run declare_shell(Declaration& verb) {
    auto options = std::make_shared<ShellOptions>();
    verb.argument("BOARD", options->board, "Which");
    verb.option("--values", "on|off", options->values, "Show the newest reports above the line");
    return [options](Environment& environment) { return run_shell(*options, environment); };
}

}  // namespace

Verb shell_verb() {
    return {
        "shell", "Commands for one board, typed one after the other, with its values in sight",
        "In it, SERVICE COMMAND [ARG...] is what asipctl send does, and every other command is one of\n"
        "asipctl for this board: get SERVICE, pin 13 high, subscribe SERVICE. Tab completes; lines are kept\n"
        "in $XDG_STATE_HOME/asipctl/history. Where standard input is no terminal, each of its lines is a\n"
        "command, and the exit status is that of the first that failed.\n"
        "Examples:\n"
        "  asipctl shell uno1\n"
        "  asipctl shell uno1 --values off\n"
        "  printf 'servo write 0 90\\nget distance\\n' | asipctl shell uno1",
        declare_shell};
}

}  // namespace asip::cli
