// SPDX-License-Identifier: Apache-2.0
#include "cli/app.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ostream>

#include "asip/program/options.hpp"
#include "cli/command_line.hpp"
#include "cli/complete.hpp"
#include "cli/context.hpp"

namespace asip::cli {
namespace {

int run_verb(CommandLine& line, Context& context) {
    if (const auto applied = line.apply(context); !applied) return context.fail_with(applied.error());
    if (const auto found = line.find_broker(context); !found) return context.fail_with(found.error());
    context.width = terminal_width(STDOUT_FILENO);
    context.colour = use_colour(line.colour(), context.terminal(), program::environment_variable);
    context.command_line = &line.app();
    context.help = [&line](const std::string& verb) { return line.help(verb); };
    return line.run(context);
}

/// The data must have arrived: a full disk is a failure. A reader that has seen enough (`| head -1`) is not.
int status_after_output(const Context& context, int status) {
    errno = 0;
    context.out.flush();
    if (context.out || context.reader_gone()) return status;
    context.err << "asipctl: cannot write the output"
                << (errno != 0 ? std::string(": ") + std::strerror(errno) : "") << std::endl;
    return status == program::kExitOk ? program::kExitFailure : status;
}

}  // namespace

int run_app(int argc, const char* const* argv, std::istream& in, std::ostream& out, std::ostream& err) {
    std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    Context context{in, out, err};
    context.out_descriptor = STDOUT_FILENO;
    if (!arguments.empty() && arguments.front() == "__complete") {
        arguments.erase(arguments.begin());
        CommandLine all(all_verbs());
        return run_complete(arguments, all, context);
    }
    CommandLine line(all_verbs(), arguments);
    const auto ended = line.parse(std::move(arguments));
    return status_after_output(context, ended ? *ended : run_verb(line, context));
}

}  // namespace asip::cli
