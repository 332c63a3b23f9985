// SPDX-License-Identifier: Apache-2.0
#include "cli/app.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ostream>

#include "asip/program/options.hpp"
#include "cli/command_line.hpp"
#include "cli/complete.hpp"
#include "cli/environment.hpp"
#include "cli/text/terminal_buffer.hpp"

namespace asip::cli {
namespace {

int run_verb(CommandLine& line, Environment& environment) {
    if (const auto applied = line.apply(environment); !applied) return environment.fail_with(applied.error());
    if (const auto found = line.find_broker(environment); !found) return environment.fail_with(found.error());
    environment.width = terminal_width(STDOUT_FILENO);
    environment.colour = use_colour(line.colour(), environment.terminal(), program::environment_variable);
    environment.help = [&line](const std::string& verb) { return line.help(verb); };
    return line.run(environment);
}

/// The data must have arrived: a full disk is a failure. A reader that has seen enough (`| head -1`) is not.
int status_after_output(const Environment& environment, std::ostream& out, int status) {
    errno = 0;
    environment.out.flush();
    out.flush();  // help goes there without the environment
    if ((environment.out && out) || environment.reader_gone()) return status;
    environment.err << "asipctl: cannot write the output"
                    << (errno != 0 ? std::string(": ") + std::strerror(errno) : "") << std::endl;
    return status == program::kExitOk ? program::kExitFailure : status;
}

}  // namespace

int run_app(const std::vector<Verb>& verbs, int argc, const char* const* argv, std::istream& in,
            std::ostream& out, std::ostream& err) {
    std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    TerminalBuffer out_buffer(out.rdbuf());
    TerminalBuffer err_buffer(err.rdbuf());
    std::ostream shown_out(&out_buffer);
    std::ostream shown_err(&err_buffer);
    Environment environment{in, shown_out, shown_err};
    environment.out_descriptor = STDOUT_FILENO;
    if (arguments.empty()) arguments.emplace_back("--help");
    if (arguments.front() == "__complete") {
        arguments.erase(arguments.begin());
        CommandLine all(verbs);
        return run_complete(arguments, all, environment);
    }
    CommandLine line(verbs, arguments);
    const auto ended = line.parse(std::move(arguments));
    return status_after_output(environment, out, ended ? *ended : run_verb(line, environment));
}

}  // namespace asip::cli
