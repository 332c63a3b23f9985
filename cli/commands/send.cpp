// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "asip/model/json.hpp"
#include "asip/text/file_text.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/group_command.hpp"
#include "cli/ask/hold.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"

namespace asip::cli {
namespace {

struct SendOptions {
    std::string target;              ///< may be empty with from_input
    std::vector<std::string> words;  ///< command and arguments
    SelectorText selector{};         ///< to all boards with these labels that the target matches
    std::string raw;                 ///< a request line for the board itself, instead of words
    bool from_input = false;         ///< one command a line of standard input
    bool no_wait = false;            ///< do not wait for answers
    std::size_t in_flight = 16;      ///< commands of standard input that may be unanswered at a time
    std::optional<std::chrono::milliseconds> hold{};    ///< undo it when it is not renewed for so long
    std::optional<std::chrono::milliseconds> during{};  ///< with hold: end after so long; none: at Ctrl-C
    OutputOptions output{};
};

/// One `asipctl send`: finds boards once, sends, and reports answers in the order of the commands.
class Sender : OnTheBus {
  public:
    Sender(const SendOptions& options, Environment& environment)
        : OnTheBus(environment),
          options_(options),
          records_(options.output,
                   options.from_input ? RecordPrinter::Count::kStream : RecordPrinter::Count::kOne,
                   environment.out) {}

    int run(const std::optional<bus::LabelSelector>& labels) {
        if (const auto status = connect()) return *status;
        if (options_.from_input) return run_input();
        if (labels)
            return send_to_group({*parse_target(options_.target, true), *labels, options_.words, options_.raw,
                                  options_.no_wait, options_.in_flight, options_.output},
                                 environment_, session_, source_);
        const auto command = prepare(options_.target, options_.words, options_.raw);
        if (!command) return environment_.fail_with(command.error());
        if (options_.hold)
            return hold_command(environment_, session_, *command, *options_.hold, options_.during,
                                options_.output);
        send(*command, {});
        drain(0);
        return status_;
    }

  private:
    struct Waiting {
        std::string where;  // "line 3: ", or nothing
        BoardCommand command;
        std::optional<bus::Reply> reply;
        BusSession::Call call;
    };

    int run_input() {
        std::string line;
        for (std::size_t number = 1; !session_.stopped() && std::getline(environment_.in, line); ++number) {
            const auto where = "line " + std::to_string(number) + ": ";
            if (number == 1 && text::is_utf16(line))
                return environment_.fail_with(
                    {program::kExitUsage, "commands are in UTF-8, and these are UTF-16: save them as UTF-8"});
            if (number == 1) line = std::string(text::without_mark(line));
            const auto first = line.find_first_not_of(" \t\r");
            if (first == std::string::npos || line[first] == '#') continue;
            const auto command = prepare_line(line);
            if (!command) {
                drain(0);
                report_failure(where, command.error());
                continue;
            }
            drain(options_.in_flight - 1);
            send(*command, where);
        }
        drain(0);
        return status_;
    }

    Outcome<BoardCommand> prepare_line(const std::string& line) {
        auto words = split_words(line);
        if (!words) return failure(program::kExitUsage, words.error());
        if (!options_.target.empty()) return prepare(options_.target, *words, {});
        const auto target = words->front();
        words->erase(words->begin());
        return prepare(target, *words, {});
    }

    Outcome<BoardCommand> prepare(const std::string& text, const std::vector<std::string>& words,
                                  const std::string& raw) {
        const auto target = parse_target(text);
        if (!target) return tl::unexpected(target.error());
        auto found = boards_.find(target->board);
        if (found == boards_.end()) {
            auto board = find_living_board(source_, target->board);
            if (!board) return tl::unexpected(board.error());
            found = boards_.emplace(target->board, std::move(*board)).first;
        }
        const auto of_board = [&](const std::string& line) {
            auto command = make_raw_command(environment_, target->board, line);
            if (command) command->plain = found->second.item.names_only;
            return command;
        };
        if (!raw.empty()) return of_board(raw);
        if (target->service.empty()) {
            // A board alone takes request lines.
            if (words.size() == 1) return of_board(words.front());
            return failure(program::kExitUsage, "which service of " + target->board + "? Write " +
                                                    target->board + "/SERVICE COMMAND ...");
        }
        const auto service = find_service(found->second, target->service);
        if (!service) return tl::unexpected(service.error());
        return make_command(environment_, found->second, *service, words);
    }

    void send(const BoardCommand& command, const std::string& where) {
        if (options_.no_wait) {
            session_.publish(command.topic, command.payload, 1);
            return;
        }
        auto& waiting = waiting_.emplace_back(Waiting{where, command, std::nullopt, {}});
        auto sent = command.to_send();
        sent.silence = "no answer on " + command.topic + " within " +
                       std::to_string(environment_.timeout.count()) + " ms";
        waiting.call =
            session_.command(std::move(sent), [&waiting](const bus::Reply& reply) { waiting.reply = reply; });
    }

    /// Waits until at most `maximum` commands are unanswered.
    void drain(std::size_t maximum) {
        while (waiting_.size() > maximum) {
            const auto& oldest = waiting_.front();
            session_.run_until([&] { return oldest.reply.has_value(); }, Time::max());
            report(oldest, oldest.reply.value_or(not_waited_for()));
            waiting_.pop_front();
        }
    }

    void report(const Waiting& done, const bus::Reply& reply) {
        if (!options_.output.for_people())
            print(done.command, *model::parse_json(bus::to_json_text(reply)));
        else if (reply.succeeded())
            environment_.say(answer_text(reply));
        if (!reply.succeeded()) report_failure(done.where, failure_of(reply, done.command.line + ": "));
    }

    void print(const BoardCommand& command, nlohmann::json record) {
        record["target"] = command.target;
        record["line"] = command.line;
        records_.print(record);
    }

    void report_failure(const std::string& where, const Failure& failed) {
        environment_.note(where + failed.text);
        if (status_ == program::kExitOk) status_ = failed.status;
    }

    const SendOptions& options_;
    RecordPrinter records_;
    std::map<std::string, KnownBoard> boards_;
    std::deque<Waiting> waiting_;
    int status_ = program::kExitOk;
};

/// `asipctl send`: one command, or those of standard input in order; the status is that of the first that
/// failed. A target with wildcards, or a selector: the same command to many boards.
int run_send(const SendOptions& options, Environment& environment) {
    if (options.target.empty() && !options.from_input) {
        return environment.fail_with(
            {program::kExitUsage, "send what to whom? Write BOARD/SERVICE COMMAND [ARG...]"});
    }
    if (!options.raw.empty() && (options.from_input || !options.words.empty()))
        return environment.fail_with({program::kExitUsage, "--raw goes with a board alone"});
    const auto target = parse_target(options.target.empty() ? "*" : options.target, true);
    if (!target) return environment.fail_with(target.error());
    const auto labels = parse_selector(options.selector);
    if (!labels) return environment.fail_with(labels.error());
    const bool many = !options.from_input && (options.selector || target->is_pattern());
    if (options.from_input && (options.selector || (!options.target.empty() && target->is_pattern())))
        return environment.fail_with({program::kExitUsage, "--stdin goes with one board a line"});
    if (many && options.hold)
        return environment.fail_with({program::kExitUsage, "--hold goes with one board"});
    if (options.hold && (options.from_input || options.no_wait || !options.raw.empty()))
        return environment.fail_with({program::kExitUsage, "--hold goes with one command of a service"});
    if (options.during && !options.hold)
        return environment.fail_with({program::kExitUsage, "--for goes with --hold"});
    return Sender(options, environment).run(many ? std::optional(*labels) : std::nullopt);
}

Run declare_send(Declaration& verb) {
    auto options = std::make_shared<SendOptions>();
    verb.argument("BOARD/SERVICE", options->target,
                  "Whom; BOARD alone takes request lines. With * and ? as in a shell, or -l: several boards",
                  Declaration::Needed::kNo);
    verb.arguments("COMMAND", options->words,
                   "Command and arguments, or one JSON object; see asipctl show BOARD/SERVICE",
                   Declaration::Needed::kNo);
    declare_selector(verb, options->selector);
    verb.option("--raw", "LINE", options->raw, "Send this ASIP request line to the board, as S,W,0,90");
    verb.flag("--stdin", options->from_input,
              "Read commands from standard input, one a line: [BOARD/SERVICE] COMMAND [ARG...]");
    verb.flag("--no-wait", options->no_wait, "Do not wait for the acknowledgement");
    verb.option("--in-flight", "COUNT", options->in_flight,
                "With --stdin: how many may be unanswered at a time", 1, 256);
    verb.option("--hold", options->hold,
                "Hold the command: renew it until Ctrl-C, and let the board's agent undo it when it hears "
                "nothing for so long");
    verb.option("--for", options->during, "With --hold: end after so long");
    verb.output(options->output, {Output::kText},
                {"board", "target", "line", "status", "proof", "answer", "code", "error", "reason"});
    return [options](Environment& environment) { return run_send(*options, environment); };
}

}  // namespace

Verb send_verb() {
    return {"send", "Give a service a command and wait for its acknowledgement",
            "Prints ok, or what the board answered. Exit status: 0 executed by the board, 1 refused, 4 no "
            "answer.\n"
            "To several boards: a table of what each answered; 0 only where all executed it. Nothing is sent "
            "where the command is wrong for one of them.\n"
            "With --hold the command is undone at Ctrl-C, and by the board's agent when asipctl, the network "
            "or the broker dies.\n"
            "Examples:\n"
            "  asipctl send uno1/servo write 0 90\n"
            "  asipctl send uno1/servo '{\"write\":{\"servo\":0,\"angle\":90}}'\n"
            "  asipctl send uno1 --raw S,W,0,90\n"
            "  asipctl send '*/servo' write 0 90 -l room=lab\n"
            "  asipctl send robot/motors power 0 120 --hold 500ms\n"
            "  asipctl send robot/motors drive 120 120 --hold 0.5 --for 3s\n"
            "  printf 'uno1/servo write 0 10\\nuno1/servo write 0 170\\n' | asipctl send --stdin",
            declare_send};
}

}  // namespace asip::cli
