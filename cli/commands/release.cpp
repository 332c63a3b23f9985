// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "cli/declaration.hpp"
#include "cli/find/target.hpp"
#include "cli/flash/lent_port.hpp"

namespace asip::cli {
namespace {

struct ReleaseOptions {
    std::string board;
    std::chrono::milliseconds time{60'000};
    bool back = false;
    OutputOptions output{};
};

/// The exit status.
Outcome<int> give_back(const ReleaseOptions& options, Environment& environment, LentPort& port) {
    const auto taken = port.give_back();
    if (!taken) return tl::unexpected(taken.error());
    if (!options.output.for_people()) {
        RecordPrinter(options.output, RecordPrinter::Count::kOne, environment.out)
            .print({{"board", options.board},
                    {"state", "online"},
                    {"same", taken->same},
                    {"sketch", taken->sketch},
                    {"was", taken->sketch_before},
                    {"chip", taken->chip}});
    } else {
        environment.say(taken->sketch);
    }
    if (taken->same) return program::kExitOk;
    return environment.fail_with(
        {program::kExitFailure, "another board answers at the port of " + options.board});
}

Outcome<int> let_go(const ReleaseOptions& options, Environment& environment, LentPort& port) {
    const auto released = port.release(std::chrono::ceil<std::chrono::seconds>(options.time));
    if (!released) return tl::unexpected(released.error());
    if (!options.output.for_people()) {
        RecordPrinter(options.output, RecordPrinter::Count::kOne, environment.out)
            .print({{"board", options.board},
                    {"state", "updating"},
                    {"kind", released->kind},
                    {"path", released->path},
                    {"host", released->host},
                    {"until", released->until},
                    {"chip", released->chip},
                    {"sketch", released->sketch}});
        return program::kExitOk;
    }
    environment.say(released->path);
    environment.note("free on " + released->host + " until " + released->until +
                     "; earlier: asipctl release " + options.board + " --back");
    return program::kExitOk;
}

Outcome<int> run_on_board(const ReleaseOptions& options, Environment& environment, BusSession& session,
                          BoardSource& source) {
    if (const auto board = find_board_with_agent(source, options.board); !board)
        return tl::unexpected(board.error());
    LentPort port(environment, session, options.board);
    return options.back ? give_back(options, environment, port) : let_go(options, environment, port);
}

int run_release(const ReleaseOptions& options, Environment& environment) {
    const auto target = parse_target(options.board);
    if (!target) return environment.fail_with(target.error());
    if (!target->service.empty())
        return environment.fail_with({program::kExitUsage, "release takes a board, not a service"});
    if (options.time > std::chrono::hours(1))
        return environment.fail_with(
            {program::kExitUsage, "--for: at most 1h; release it again to prolong it"});
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    const auto done = run_on_board(options, environment, session, source);
    if (done) return *done;
    print_failure(options.output, RecordPrinter::Count::kOne, options.board, done.error(), environment.out);
    return environment.fail_with(done.error());
}

Run declare_release(Declaration& verb) {
    auto options = std::make_shared<ReleaseOptions>();
    verb.argument("BOARD", options->board, "Whose port");
    verb.option("--for", options->time, "When the agent takes it back by itself; up to 1h",
                std::chrono::milliseconds(1000));
    verb.flag("--back", options->back, "Give it back now, and tell which sketch answers there");
    verb.output(options->output, {Output::kText},
                {"board", "state", "kind", "path", "host", "until", "chip", "sketch", "same", "was", "status",
                 "error", "reason", "code"});
    return [options](Environment& environment) { return run_release(*options, environment); };
}

}  // namespace

Verb release_verb() {
    return {"release", "Makes a board's agent let go of the port, for other programs",
            "Prints the port. Meanwhile the board's state is `updating`, and commands are refused. Its agent "
            "takes\n"
            "the port back when the time is over, whatever happens to the program that has it.\n"
            "Examples:\n"
            "  asipctl release uno1 --for 10m\n"
            "  screen \"$(asipctl release uno1)\" 57600; asipctl release uno1 --back",
            declare_release};
}

}  // namespace asip::cli
