// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <list>
#include <nlohmann/json.hpp>
#include <thread>

#include "asip/text/duration.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"
#include "cli/flash/lent_port.hpp"
#include "cli/flash/load.hpp"
#include "cli/flash/programmer.hpp"

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
    LoadOptions load{};
    bool whole_class = false;
    bool update = false;
    std::optional<std::string> names;
    std::string host;
    std::size_t count = 0;
    Programming programming{};
    std::string avrdude;  ///< empty: the usual one, where it is not a simulated board
    std::string simulated;
    std::string socket;
    std::string limit = "5m";  ///< for the programmer
    SelectorText selector{};
    OutputOptions output{};
};

class Flasher {
  public:
    /// `board` and all others must outlive it.
    Flasher(const FlashOptions& options, const std::string& board, Environment& environment,
            BusSession& session, RecordPrinter& records)
        : options_(options),
          board_(board),
          environment_(environment),
          session_(session),
          records_(records),
          port_(environment, session, board) {}

    /// Finds out how it is programmed. Whatever can be wrong is found before a port is released.
    Outcome<void> plan(const KnownBoard& board) {
        auto call = call_for(board);
        if (!call) return tl::unexpected(call.error());
        call_ = std::move(*call);
        return {};
    }

    int run() {
        const auto released = port_.release(kLease);
        if (!released) return fail(released.error());
        environment_.note(board_ + ": port released; starting " + call_.front());
        const auto programmed = program(call_, released->path);
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
            {program::kExitFailure, "another board answers at the port of " + board_ + " now"});
    }

    int fail(const Failure& failure) {
        if (!options_.output.for_people() && options_.output.format.empty())
            records_.print(failure_record(board_, failure));
        return environment_.fail_with(failure);
    }

  private:
    Outcome<std::vector<std::string>> call_for(const KnownBoard& board) const {
        if (!board.description)
            return failure(
                program::kExitNoAnswer,
                "no description of " + board_ +
                    " came in time, so its port is not known; try again, or with a longer --timeout");
        if (board.description->link.kind != "serial")
            return failure(program::kExitFailure,
                           board_ + " is not at a serial port; only such a board can be flashed");
        const auto& description = *board.description;
        if (description.agent.host != program::host_name())
            return failure(program::kExitFailure, board_ + " is at a port of " + description.agent.host +
                                                      "; run asipctl flash there");
        if (const auto port = check_port(description.link.path); !port)
            return failure(program::kExitFailure, board_ + ": " + port.error());
        if (!std::filesystem::is_regular_file(options_.programming.image))
            return failure(program::kExitUsage, options_.programming.image + " is not a file");
        const bool by_avrdude = options_.simulated.empty() && !options_.avrdude.empty();
        if (!by_avrdude && (!options_.simulated.empty() || is_simulated_port(description.link.path)))
            return simulator_call(options_.simulated.empty() ? board_ : options_.simulated,
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
        if (const auto port = check_port(path); !port) return failure(program::kExitFailure, port.error());
        const auto lock = PortLock::take(path, [this](Duration time) { session_.run_for(time); });
        if (!lock) return failure(program::kExitFailure, lock.error());
        auto programmer = RunningProgram::start(call);
        if (!programmer) return failure(program::kExitFailure, programmer.error());
        const auto limit = Clock::now() + *text::parse_duration(options_.limit);
        bool stopped = false;
        auto prolong = Clock::now() + kProlongEvery;
        std::optional<int> status;
        while (!(status = programmer->ended())) {
            if (session_.stopped())
                std::this_thread::sleep_for(kLookEvery);  // Ctrl-C reached the programmer, too
            else
                session_.run_for(kLookEvery);
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
                               " and was stopped; does the boot loader answer? Reset the board and try "
                               "again, or give it longer: --limit DURATION");
        if (*status == 0) return {};
        return failure(program::kExitFailure, call.front() + " failed with status " +
                                                  std::to_string(*status) +
                                                  "; is it the right board, and its boot loader there?");
    }

    void print(const TakenPort& taken, bool programmed) {
        if (!options_.output.for_people()) {
            records_.print({{"board", board_},
                            {"programmed", programmed},
                            {"same", taken.same},
                            {"sketch", taken.sketch},
                            {"was", taken.sketch_before},
                            {"chip", taken.chip}});
            return;
        }
        if (!programmed) return environment_.note(board_ + ": answers with " + taken.sketch);
        environment_.say(board_ + ": " + taken.sketch + ", was " + taken.sketch_before);
    }

    const FlashOptions& options_;
    const std::string& board_;
    Environment& environment_;
    BusSession& session_;
    RecordPrinter& records_;
    LentPort port_;
    std::vector<std::string> call_;
};

/// One `asipctl flash`.
class FlashRun : OnTheBus {
  public:
    FlashRun(const FlashOptions& options, Environment& environment, RecordPrinter::Count count)
        : OnTheBus(environment), options_(options), records_(options.output, count, environment.out) {}

    int one() {
        if (const auto status = connect()) return *status;
        Flasher flasher(options_, options_.board, environment_, session_, records_);
        const auto board = find_board_with_agent(source_, options_.board);
        if (!board) return flasher.fail(board.error());
        if (const auto planned = flasher.plan(*board); !planned) return flasher.fail(planned.error());
        return flasher.run();
    }

    /// One after the other. What is wrong with one of them is found before the first port is released.
    int group(const Target& target, const bus::LabelSelector& labels) {
        if (const auto status = connect()) return *status;
        const auto boards = choose_boards(source_, target, labels);
        if (!boards) return environment_.fail_with(boards.error());
        std::list<Flasher> flashers;
        for (const auto& board : *boards) {
            if (is_left_out(board)) continue;
            flashers.emplace_back(options_, board.item.board, environment_, session_, records_);
            if (const auto planned = flashers.back().plan(board); !planned)
                return environment_.fail_with(
                    {planned.error().status, board.item.board + ": " + planned.error().text});
        }
        if (flashers.empty())
            return environment_.fail_with(
                {program::kExitNoAnswer, "none of these boards is at a port of " + program::host_name()});
        int status = program::kExitOk;
        std::size_t done = 0;
        for (auto& flasher : flashers) {
            if (session_.stopped()) break;
            const auto ended = flasher.run();
            if (ended == program::kExitOk) ++done;
            if (status == program::kExitOk) status = ended;
        }
        records_.finish();
        environment_.note(std::to_string(done) + " of " + std::to_string(flashers.size()) +
                          " boards have the new firmware");
        return status == program::kExitOk && done < flashers.size() ? program::kExitFailure : status;
    }

  private:
    bool is_left_out(const KnownBoard& board) {
        const auto& name = board.item.board;
        const bool elsewhere = board.description && board.description->agent.host != program::host_name();
        if (board.item.state == "offline")
            environment_.note(name + " is left out: it is offline");
        else if (elsewhere)
            environment_.note(name + " is left out: it is at a port of " + board.description->agent.host +
                              "; run asipctl flash there, too");
        return board.item.state == "offline" || elsewhere;
    }

    const FlashOptions& options_;
    RecordPrinter records_;
};

/// What was given and means nothing here; empty: nothing.
std::string without_meaning(const FlashOptions& options) {
    const bool file = !options.programming.image.empty();
    if (!options.whole_class && !options.update && options.board.empty())
        return "name a board, or give --class or --update";
    if (options.update && (file || options.whole_class || !options.load.board.empty() || options.load.force))
        return "--update goes with boards and -l alone: their agents know what to load";
    if (options.whole_class && !options.board.empty())
        return "--class takes no BOARD: it is for all that are plugged in";
    if (!options.whole_class && (options.names || !options.host.empty() || options.count != 0))
        return "--names, --at and --count go with --class";
    if (file && (!options.load.board.empty() || options.load.force))
        return "--board and --force are for firmware of the agent's machine, without a FILE";
    return {};
}

int run_flash(const FlashOptions& options, Environment& environment) {
    if (const auto fault = without_meaning(options); !fault.empty())
        return environment.fail_with({program::kExitUsage, fault});
    if (options.whole_class)
        return run_class(
            {options.load, options.names, options.host.empty() ? program::host_name() : options.host,
             options.count, options.output},
            environment);
    if (const auto limit = text::parse_duration(options.limit); !limit)
        return environment.fail_with({program::kExitUsage, "--limit: " + limit.error()});
    const auto target = parse_target(options.update && options.board.empty() ? "*" : options.board, true);
    if (!target) return environment.fail_with(target.error());
    if (!target->service.empty())
        return environment.fail_with({program::kExitUsage, "flash takes a board, not a service"});
    const auto labels = parse_selector(options.selector);
    if (!labels) return environment.fail_with(labels.error());
    if (options.update) return run_update({*target, *labels, options.output}, environment);
    if (options.programming.image.empty())
        return !options.selector && !target->is_pattern()
                   ? run_load(options.load, options.board, options.output, environment)
                   : environment.fail_with(
                         {program::kExitUsage, "for several boards give a FILE, --update, or --class"});
    if (!options.selector && !target->is_pattern())
        return FlashRun(options, environment, RecordPrinter::Count::kOne).one();
    if (!options.simulated.empty())
        return environment.fail_with({program::kExitUsage, "--simulated goes with one board"});
    return FlashRun(options, environment, RecordPrinter::Count::kList).group(*target, *labels);
}

Run declare_flash(Declaration& verb) {
    auto options = std::make_shared<FlashOptions>();
    auto& programming = options->programming;
    verb.argument("BOARD", options->board,
                  "Which; with * and ? as in a shell, or with -l: several, one after the other",
                  Declaration::Needed::kNo);
    verb.argument("FILE", programming.image,
                  "The firmware: .hex or .elf; without it AsipServices of the machine that the board is at",
                  Declaration::Needed::kNo);
    verb.flag("--class", options->whole_class,
              "Until Ctrl-C: each board at this machine, and each that is plugged in, that speaks no ASIP");
    verb.flag("--update", options->update,
              "Boards of the whole bus that are out of date, some at a time; it stops behind three failures");
    verb.option("--names", "PATTERN", options->names,
                "With --class: store a name on each board, student-{} with the number for {}");
    verb.option("--at", "HOST", options->host, "With --class: boards at another machine; '*': at any");
    verb.option("--count", "COUNT", options->count,
                "With --class: end after so many boards that run the firmware");
    verb.option("--firmware", "NAME", options->load.firmware,
                "Without FILE: another firmware of that machine");
    verb.option("--board", "uno|nano|nano-old|mega", options->load.board,
                "Without FILE: which it is, where USB does not tell; nano-old: as sold until 2018");
    verb.flag("--force", options->load.force, "Without FILE: also where the board runs ASIP already");
    declare_selector(verb, options->selector);
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
    verb.output(options->output, {Output::kText},
                {"board", "programmed", "same", "sketch", "version", "was", "chip", "port", "result",
                 "seconds", "status", "error", "reason", "code"});
    return [options](Environment& environment) { return run_flash(*options, environment); };
}

}  // namespace

Verb flash_verb() {
    return {"flash", "Loads firmware into a board, by avrdude, and gives it back to the bus",
            "With a FILE it runs on the machine that the board is at. The board's agent lets go of the port, "
            "and\n"
            "takes it back within 20 s should this program die. Prints the new and the old sketch. Boot "
            "loaders of\n"
            "Uno, Nano, Mega and their kin are known; for others give --part, --programmer and --baud.\n"
            "Without a FILE the board's agent loads firmware that its machine has, into a board that speaks "
            "no ASIP.\n"
            "Several boards: those at this machine, one after the other; nothing is loaded where one of them "
            "cannot be.\n"
            "Examples:\n"
            "  asipctl flash lab-usb-140-3\n"
            "  asipctl flash --class --names student-{}\n"
            "  asipctl flash --update -l room=lab\n"
            "  asipctl flash uno1 AsipServices.hex\n"
            "  asipctl flash nano AsipHello.hex --baud 57600\n"
            "  asipctl flash 'uno*' AsipServices.hex -l room=lab\n"
            "  asipctl flash desk build/dev/firmware/images/asip_uno.elf --socket sim.sock",
            declare_flash};
}

}  // namespace asip::cli
