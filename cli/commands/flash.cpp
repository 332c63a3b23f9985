// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <thread>

#include "asip/text/duration.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"
#include "cli/flash/lent_port.hpp"
#include "cli/flash/programmer.hpp"
#include "cli/record/replay_board.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

/// An agent whose asipctl died has its port back after so long; it is prolonged while the programmer runs.
constexpr std::chrono::seconds kLease = 20s;
constexpr Duration kProlongEvery = 5s;
constexpr auto kLookEvery = 50ms;
constexpr Duration kStopTime = 2s;  // to end by itself

struct FlashOptions {
    std::string board;
    Programming programming{};
    std::string avrdude;  ///< empty: the usual one, where it is not a simulated board
    std::string simulated;
    std::string socket;
    std::string limit = "5m";  ///< for the programmer
    OutputOptions output{};
};

class Flasher {
  public:
    Flasher(const FlashOptions& options, Environment& environment)
        : options_(options),
          environment_(environment),
          session_(environment),
          source_(environment, session_),
          port_(environment, session_, options.board) {}

    int run() {
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        const auto call = plan();
        if (!call) return fail(call.error());
        const auto released = port_.release(kLease);
        if (!released) return fail(released.error());
        environment_.note(options_.board + ": port released; starting " + call->front());
        const auto programmed = program(*call, released->path);
        if (session_.stopped()) {
            port_.give_back_unseen();
            return fail({program::kExitFailure, "interrupted; the agent takes the port back"});
        }
        const auto taken = port_.give_back();
        if (!programmed) environment_.note(programmed.error().text);
        if (!taken) return fail(taken.error());
        print(*taken, programmed.has_value());
        if (!programmed) return program::kExitFailure;
        if (taken->same) return program::kExitOk;
        return environment_.fail_with(
            {program::kExitFailure, "another board answers at the port of " + options_.board + " now"});
    }

  private:
    int fail(const Failure& failure) {
        print_failure(options_.output, RecordPrinter::Count::kOne, options_.board, failure, environment_.out);
        return environment_.fail_with(failure);
    }

    /// The call of the programmer. Whatever can be wrong is found before the port is released.
    Outcome<std::vector<std::string>> plan() {
        const auto board = find_board_with_agent(source_, options_.board);
        if (!board) return tl::unexpected(board.error());
        if (board->description && board->description->link.kind == kReplayLink)
            return failure(program::kExitFailure, options_.board + " is recorded (" +
                                                      board->description->link.path +
                                                      "): there is no chip to load firmware into");
        if (!board->description)
            return failure(
                program::kExitNoAnswer,
                "no description of " + options_.board +
                    " came in time, so nobody knows its port; try again, or with a longer --timeout");
        if (board->description->link.kind != "serial")
            return failure(program::kExitFailure,
                           options_.board + " is not at a serial port; only such a board can be flashed");
        const auto& description = *board->description;
        if (description.agent.host != program::host_name())
            return failure(program::kExitFailure, options_.board + " is at a port of " +
                                                      description.agent.host + "; run asipctl flash there");
        if (!std::filesystem::is_regular_file(options_.programming.image))
            return failure(program::kExitUsage, options_.programming.image + " is not a file");
        const bool by_avrdude = options_.simulated.empty() && !options_.avrdude.empty();
        if (!by_avrdude && (!options_.simulated.empty() || is_simulated_port(description.link.path)))
            return simulator_call(options_.simulated.empty() ? options_.board : options_.simulated,
                                  options_.programming.image, options_.socket);
        auto what = options_.programming;
        what.path = description.link.path;
        what.chip = description.firmware.chip;
        if (by_avrdude) what.avrdude = options_.avrdude;
        auto call = avrdude_call(what);
        if (!call) return failure(program::kExitUsage, call.error());
        return std::move(*call);
    }

    Outcome<void> program(const std::vector<std::string>& call, const std::string& path) {
        const auto lock = PortLock::take(path, [this](Duration time) { session_.run_for(time); });
        if (!lock) return failure(program::kExitFailure, lock.error());
        auto programmer = RunningProgram::start(call);
        if (!programmer) return failure(program::kExitFailure, programmer.error());
        const auto limit = Clock::now() + *text::parse_duration(options_.limit);
        bool stopped = false;
        auto prolong = Clock::now() + kProlongEvery;
        std::optional<int> status;
        while (!(status = programmer->ended())) {
            if (session_.stopped()) {
                std::this_thread::sleep_for(kLookEvery);  // Ctrl-C reached the programmer, too
            } else {
                session_.run_for(kLookEvery);
            }
            if (Clock::now() >= limit) {
                programmer->stop(Clock::now() >= limit + kStopTime);
                stopped = true;
            }
            if (Clock::now() < prolong) continue;
            prolong = Clock::now() + kProlongEvery;
            port_.prolong(kLease);
        }
        if (stopped)
            return failure(program::kExitFailure,
                           call.front() + " did not end within " + options_.limit +
                               " and was stopped; does the boot loader answer? Reset the board "
                               "and try again, or give it longer: --limit DURATION");
        if (*status == 0) return {};
        return failure(program::kExitFailure, call.front() + " failed with status " +
                                                  std::to_string(*status) +
                                                  "; is it the right board, and its boot loader there?");
    }

    void print(const TakenPort& taken, bool programmed) {
        if (!options_.output.for_people()) {
            RecordPrinter(options_.output, RecordPrinter::Count::kOne, environment_.out)
                .print({{"board", options_.board},
                        {"programmed", programmed},
                        {"same", taken.same},
                        {"sketch", taken.sketch},
                        {"was", taken.sketch_before},
                        {"chip", taken.chip}});
            return;
        }
        environment_.out << options_.board << ": " << for_terminal(taken.sketch) << ", was "
                         << for_terminal(taken.sketch_before) << std::endl;
    }

    const FlashOptions& options_;
    Environment& environment_;
    BusSession session_;
    BoardSource source_;
    LentPort port_;
};

int run_flash(const FlashOptions& options, Environment& environment) {
    if (options.board.find_first_of(",*?[") != std::string::npos)
        return environment.fail_with(
            {program::kExitUsage, "flash takes one board; call it once for each, where the board is"});
    if (const auto limit = text::parse_duration(options.limit); !limit)
        return environment.fail_with({program::kExitUsage, "--limit: " + limit.error()});
    const auto target = parse_target(options.board);
    if (!target) return environment.fail_with(target.error());
    if (!target->service.empty())
        return environment.fail_with({program::kExitUsage, "flash takes a board, not a service"});
    return Flasher(options, environment).run();
}

Run declare_flash(Declaration& verb) {
    auto options = std::make_shared<FlashOptions>();
    auto& programming = options->programming;
    verb.argument("BOARD", options->board, "Which; one alone");
    verb.argument("FILE", programming.image, "The firmware: .hex or .elf");
    verb.option("--part", "NAME", programming.part,
                "The chip, as avrdude calls it; default: by the board's chip");
    verb.option("--programmer", "NAME", programming.method, "avrdude's programmer; default: by the chip");
    verb.option("--baud", "BAUD", programming.baud, "Of the boot loader; 0: by the chip");
    verb.option("--avrdude", "FILE", options->avrdude,
                "This programmer, called as avrdude is, also at a pseudo-terminal");
    verb.option("--simulated", "NAME", options->simulated,
                "A board of asip-sim of this name; default for pseudo-terminals: the board's name");
    verb.option("--limit", "DURATION", options->limit, "A programmer that takes longer is stopped");
    verb.option("--socket", "FILE", options->socket, "Control socket of asip-sim; default: its usual one");
    verb.output(
        options->output, {Output::kText},
        {"board", "programmed", "same", "sketch", "was", "chip", "status", "error", "reason", "code"});
    return [options](Environment& environment) { return run_flash(*options, environment); };
}

}  // namespace

Verb flash_verb() {
    return {
        "flash", "Loads firmware into a board, by avrdude, and gives it back to the bus",
        "Runs on the machine that the board is at. The board's agent lets go of the port, and takes it back\n"
        "within 20 s should this program die. Prints the new and the old sketch. Boot loaders of Uno, Nano,\n"
        "Mega and their kin are known; for others give --part, --programmer and --baud.\n"
        "Examples:\n"
        "  asipctl flash uno1 AsipServices.hex\n"
        "  asipctl flash nano AsipHello.hex --baud 57600\n"
        "  asipctl flash desk build/dev/firmware/images/asip_uno.elf --socket sim.sock",
        declare_flash};
}

}  // namespace asip::cli
