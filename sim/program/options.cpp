#include "sim/program/options.hpp"

#include <CLI/CLI.hpp>

namespace asip::sim {
namespace {

constexpr int kUsage = 2;

const char* const kDescription =
    "Runs Arduino boards that are not there: real firmware in a simulated chip, in real time, each as a "
    "serial port\n"
    "that any program can open.\n";

const char* const kFooter =
    "\nCommands (press button1, set pot1 0.3, reset, unplug, list, help, ...) are read from standard input, "
    "and come from\n"
    "\"asip-sim ctl\". What happens on the boards is printed, one line each.\n"
    "\nExamples:\n"
    "  asip-sim uno.json                      the board of a file; its port is printed\n"
    "  asip-sim uno.json mega.json --json     two boards, changes as JSON lines\n"
    "  asip-sim AsipHello.elf --link /tmp/uno a bare Uno, also at /tmp/uno\n"
    "  asip-sim uno.json --tcp 6789           the same serial port over TCP\n"
    "  asip-sim ctl press button1             from another terminal\n"
    "  asip-sim ctl set uno/pot1 0.3\n"
    "\nExit status: 0 ended as asked, 1 failed while running, 2 bad option or bad input file;\n"
    "ctl: 0 done, 1 refused, 2 bad option, 5 no asip-sim answers.\n";

}  // namespace

Parsed parse_options(int argc, char** argv) {
    Parsed parsed;
    auto& options = parsed.options;
    CLI::App app(kDescription, "asip-sim");
    app.footer(kFooter);
    app.set_version_flag("--version", std::string("asip-sim ") + ASIP_VERSION);
    app.add_option("BOARD", options.boards,
                   "Board files (.json), or firmware images (.elf, .hex) for bare boards");
    app.add_option("--board", options.board, "Which board an image is for: uno, mega, leonardo")
        ->capture_default_str();
    app.add_option("--link", options.links, "Symbolic link to the port; repeat it for the next boards")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    app.add_option("--tcp", options.tcp_ports,
                   "TCP port on 127.0.0.1 (0: any); repeat it for the next boards")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(CLI::Range(0, 65535));
    app.add_flag("--json", options.json, "Print JSON lines");
    app.add_option("--socket", options.socket, "Unix socket for asip-sim ctl (usual: one for each user)");
    app.add_flag("--no-socket", options.no_socket, "Do not listen for asip-sim ctl");
    unsigned slice = 0;
    app.add_option("--slice", slice,
                   "Microseconds that a board runs at a time (usual: 200, with many boards 1000)")
        ->check(CLI::Range(50, 100000));
    app.add_option("--threads", options.threads, "Threads that share the boards (usual: one for each core)")
        ->check(CLI::Range(1, 64));

    auto* control = app.add_subcommand("ctl", "Send one command to a running asip-sim");
    control->footer(
        "\nExamples:\n  asip-sim ctl press button1\n  asip-sim ctl set sonar 42\n  asip-sim ctl unplug uno\n"
        "  asip-sim ctl help\n");
    control->add_option("--socket", options.socket, "The socket that asip-sim listens on");
    control->add_option("COMMAND", options.command, "The command; help lists them")->required();
    control->positionals_at_end();

    try {
        app.parse(argc, argv);
        options.control = control->parsed();
        options.slice = std::chrono::microseconds(slice);
        if (!options.control && options.boards.empty()) throw CLI::RequiredError("BOARD");
    } catch (const CLI::ParseError& error) {
        const bool is_answer = error.get_exit_code() == 0;  // --help, --version
        app.exit(error, std::cout, std::cerr);
        parsed.exit_status = is_answer ? 0 : kUsage;
    }
    return parsed;
}

}  // namespace asip::sim
