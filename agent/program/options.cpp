// SPDX-License-Identifier: Apache-2.0
#include "agent/program/options.hpp"

namespace asip::agent {

void declare_options(program::App& app, program::Settings& settings, RawOptions& raw) {
    const auto board = [&](const program::Option& each) { settings.setting(each).group("Board"); };
    const auto bus = [&](const program::Option& each) { settings.setting(each).group("Bus"); };
    const auto direct = [&](const program::Option& each) { settings.setting(each).group("Point to point"); };
    board(app.add_option("--serial", raw.serial, "Serial port of the board, e.g. /dev/ttyACM0"));
    board(app.add_option(
        "--tcp", raw.tcp,
        "HOST:PORT of a board with a network, HOST:PORT/frames behind a bridge of the Java programs"));
    board(app.add_option("--cables", raw.cables,
                         "Folder for boards that browsers lend at the page of asip-gateway, which "
                         "is given the same; the agent serves no other board"));
    board(app.add_option("--name", raw.name,
                         "Name of the board on the bus; default: stored on the board, else from the port"));
    board(app.add_option("--label", raw.labels,
                         "KEY=VALUE, pin.N=NAME or SERVICE/name=NAME: what to call the board by. Not to be "
                         "changed over the bus. Several: separated by commas, or several times")
              .commas());
    board(app.add_option("--state-dir", raw.state_dir,
                         "Folder to keep labels in that are set over the bus; default: "
                         "$STATE_DIRECTORY, $XDG_STATE_HOME/asip or ~/.local/state/asip"));
    board(app.add_option("--firmware-dir", raw.firmware_dir,
                         "Folder of the firmware that may be loaded into the board when a user "
                         "asks for it: AsipServices-uno.hex, AsipServices-mega.hex")
              .show_default());
    board(app.add_option("--avrdude", raw.avrdude, "The program that loads it").show_default());
    board(app.add_flag("--takeover", raw.takeover,
                       "Take the name even if another agent holds it; that one ends"));
    board(app.add_option("--reset", raw.reset, "Whether to restart the board by DTR when its port was opened")
              .words({"never", "always", "if-silent"})
              .show_default());
    board(app.add_option("--baud", raw.baud, "Rate of the line at the start")
              .range(300, 4'000'000)
              .show_default());
    board(app.add_option("--max-baud", raw.max_baud, "Highest rate to step the line up to").show_default());
    board(app.add_flag("--no-step-up", raw.no_step_up, "Leave the rate of the line alone"));
    board(app.add_flag("--checksum", raw.checksum,
                       "Put a checksum on each line from the start, where the board can; default: "
                       "on fast lines, and once the line is damaged"));
    board(
        app.add_flag("--keep-outputs", raw.keep_outputs,
                     "Leave motors and other actuators as they are found at the start; default: stop them"));
    board(app.add_option("--patience", raw.patience,
                         "Seconds without any answer after which this is not an ASIP board")
              .range(0.1, 3600.0)
              .show_default());
    bus(app.add_option("--services", raw.services, "Folder of further service models (*.json)"));
    bus(app.add_option("--lease", raw.lease, "Seconds for which an announcement holds")
            .range(3, model::kMaxLeaseSeconds)
            .show_default());
    bus(app.add_option("--statistics", raw.statistics, "How often to publish what was counted; 0s: never")
            .show_default());
    bus(app.add_option("--reports", raw.reports,
                       "shared: services report faster while subscribers demand it, and then as "
                       "before. on-demand: only what subscribers demand; plain MQTT clients "
                       "demand nothing: see resting-period. always: demands count for nothing")
            .words({"always", "shared", "on-demand"})
            .show_default());
    bus(app.add_option("--resting-period", raw.resting_period,
                       "With reports = on-demand: period while no program demands reports; 0s: no reports")
            .show_default());
    bus(app.add_option("--fastest-period", raw.fastest_period, "Shortest period that demands can bring about")
            .show_default());
    bus(app.add_option(
               "--topics", raw.topics,
               "Whose side the topics BOARD/in and BOARD/out of raw lines are named from. client-side: "
               "requests come on BOARD/out and lines of the board go to BOARD/in, for newer python-asip")
            .words({"board-side", "client-side"})
            .show_default());
    bus(app.add_option("--line-terminator", raw.terminator,
                       "What ends each raw line: none, or lf with topics = client-side, unless given")
            .words({"none", "lf", "crlf"}));
    bus(app.add_flag("--retain-values", raw.retain_values, "Retain the last value of each service"));
    direct(app.add_option("--listen", raw.listen,
                          "[HOST:]PORT[/lines|/frames] for point-to-point clients; 127.0.0.1 if no "
                          "host. Several addresses: separated by commas, or several times")
               .commas());
    direct(app.add_option("--listen-silence", raw.listen_silence,
                          "A client that sent nothing for so long gets plain lines; on port 6789, "
                          "of the published Java programs, frames")
               .show_default());
    settings.add_broker_options(raw.broker);
    settings.add_credentials_dir(raw.broker);
    settings.add_log_options(raw.log);
    settings.arrange({"serial", "tcp", "cables", "name", "label", "services", "reports", "listen", "broker",
                      "credentials", "log-level"},
                     {"firmware-dir", "avrdude", "reset", "max-baud", "checksum", "topics", "statistics",
                      "resting-period", "fastest-period", "line-terminator", "retain-values",
                      "listen-silence", "mqtt-version", "credentials-dir", "log-format"});
}

}  // namespace asip::agent
