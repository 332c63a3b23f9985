// SPDX-License-Identifier: Apache-2.0
#include "sim/program/options.hpp"

#include "asip/program/app.hpp"

namespace asip::sim {
namespace {

constexpr const char* kAbout =
    "Runs the firmware of Arduino boards in simulated chips, in real time. Each board is a serial port that "
    "any\n"
    "program can open.";

constexpr const char* kExamples =
    "Commands (press button1, set pot1 0.3, reset, unplug, list, help, ...) are read from standard input, "
    "and come\n"
    "from asip-sim ctl. What happens on the boards is printed, one line for each event.\n"
    "\n"
    "Examples:\n"
    "  asip-sim uno.json\n"
    "      The board of a file; its port is printed.\n"
    "  asip-sim uno.json mega.json --json\n"
    "      Two boards, events as JSON lines.\n"
    "  asip-sim --link /tmp/uno AsipHello.elf\n"
    "      An Uno without parts, also at /tmp/uno.\n"
    "  asip-sim uno.json --tcp 6789\n"
    "      The same serial port over TCP.\n"
    "  asip-sim mirto.json --publish-world world --broker 127.0.0.1\n"
    "      A robot; the floor that it drives on is on the bus as world, and on the gateway's page.\n"
    "  asip-sim ctl set uno/pot1 0.3\n"
    "      A command, from another terminal.\n"
    "\n"
    "Exit status: 0 ended as asked; 1 failed while running; 2 bad option or bad input file. ctl: 0 done; 1 "
    "refused;\n"
    "2 bad option; 4 no asip-sim answers.";

/// What belongs to the boards of this command line: no environment and no file can know them.
void declare_boards(program::App& app, Options& options) {
    app.add_option("BOARD", options.boards,
                   "Board files (.json), or firmware images (.elf, .hex) for bare boards");
    app.add_option("--board", options.board, "Which board an image is for: uno, mega, leonardo, nano, 1284p")
        .show_default();
    app.add_option("--link", options.links, "Symbolic link to the port; repeat it for the next boards")
        .repeated();
    app.add_option("--tcp", options.tcp_ports,
                   "TCP port on 127.0.0.1 (0: any); repeat it for the next boards")
        .repeated()
        .range(0, 65535);
}

program::App declare_control(program::App& app, std::string& socket, Options& options) {
    const auto control = app.add_subcommand("ctl", "Send one command to a running asip-sim");
    control.footer(
        "Examples:\n"
        "  asip-sim ctl press button1\n"
        "  asip-sim ctl set sonar 42\n"
        "  asip-sim ctl unplug uno\n"
        "  asip-sim ctl help");
    control.add_option("--socket", socket, "The socket that asip-sim listens on");
    control.add_option("COMMAND", options.command, "The command; help lists them").required();
    control.positionals_at_end();
    return control;
}

}  // namespace

Expected<Options, int> read_options(int argc, const char* const* argv) {
    Options options;
    std::string socket;
    unsigned slice = 0;
    program::LogOptions log;
    program::App app{kAbout, "asip-sim"};
    app.footer(kExamples);
    program::Settings settings(app, "asip-sim");
    declare_boards(app, options);
    settings.setting(app.add_flag("--json", options.json, "Print JSON lines"));
    settings.setting(
        app.add_option("--socket", socket, "Unix socket for asip-sim ctl; default: one for each user"));
    settings.setting(app.add_flag("--no-socket", options.no_socket, "Do not listen for asip-sim ctl"));
    settings.setting(
        app.add_option(
               "--slice", slice,
               "Microseconds that a board runs at a time; default: 200, with more boards than threads 1000")
            .range(50, 100000));
    settings.setting(app.add_option("--threads", options.threads,
                                    "Threads that share the boards; default: one for each core")
                         .range(1, 64));
    settings
        .setting(
            app.add_option("--publish-world", options.publish_world,
                           "Publish the world that the boards share, as a member of the bus of this name"))
        .type("NAME");
    settings.add_broker_options(options.broker);
    app.option("--broker").one_value();  // what follows it is a board
    settings.add_log_options(log);
    const auto control = declare_control(app, socket, options);

    if (const auto status = settings.parse(argc, argv)) return Unexpected<int>(*status);
    if (!control.parsed() && options.boards.empty())
        return Unexpected<int>(settings.usage_error("BOARD is missing: a board file or a firmware image"));
    if (!socket.empty()) options.socket = socket;
    options.slice = std::chrono::microseconds(slice);
    return options;
}

}  // namespace asip::sim
