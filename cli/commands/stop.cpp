// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/stop.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <list>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/text/json_reader.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"
#include "cli/text/table.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

bool is_pattern(const std::string& board) {
    return board.find_first_of("*?") != std::string::npos;
}

struct Done {
    std::vector<std::string> executed;
    std::uint64_t refused = 0;
    bool latched = false;
};

/// Any program with the credentials of a board may have answered. What cannot be read counts as nothing.
Done done_of(const std::string& answer) {
    const auto parsed = model::parse_json(answer).value_or(nlohmann::json::object());
    std::string fault;
    text::JsonReader reader(parsed, "", fault);
    return {reader.texts("executed", text::JsonReader::kNoLimit, text::JsonReader::kNoLimit),
            reader.integer("refused", 0, std::numeric_limits<std::uint32_t>::max()).value_or(0),
            reader.flag("latched")};
}

class Stopper : OnTheBus {
  public:
    Stopper(const StopOptions& options, bus::LabelSelector labels, Environment& environment)
        : OnTheBus(environment), options_(options), labels_(std::move(labels)) {}

    int run() {
        if (const auto status = connect()) return *status;
        // Named ones at once: looking them up first would cost time.
        for (const auto& board : options_.boards)
            if (!is_pattern(board)) stop(board);
        for (const auto& board : options_.boards)
            if (is_pattern(board))
                if (const auto found = stop_chosen(board); !found)
                    return environment_.fail_with(found.error());
        if (options_.selector)
            if (const auto found = stop_chosen("*"); !found) return environment_.fail_with(found.error());
        if (options_.all)
            if (const auto found = stop_all(); !found) return environment_.fail_with(found.error());
        if (asked_.empty()) {
            environment_.note(options_.resume ? "there is no board to resume" : "there is no board to stop");
            return program::kExitOk;
        }
        const auto settled = [](const Asked& asked) { return asked.reply.has_value(); };
        session_.run_until([&] { return std::all_of(asked_.begin(), asked_.end(), settled); }, Time::max());
        return show();
    }

  private:
    struct Asked {
        std::string board;
        std::optional<bus::Reply> reply;
        BusSession::Call call;
    };

    /// The agent's answer that the board did not confirm is to come before the end of our patience.
    std::string payload() const {
        const auto deadline = std::clamp<std::int64_t>(environment_.timeout.count() * 9 / 10, 50, 60000);
        nlohmann::json payload{{"deadline_ms", deadline}, {"by", who_asks(environment_)}};
        if (options_.resume) {
            payload["resume"] = true;
            return payload.dump();
        }
        if (!options_.once) payload["latch"] = true;
        if (!options_.why.empty()) payload["why"] = options_.why;
        return payload.dump();
    }

    void stop(const std::string& board) {
        const auto same = [&board](const Asked& one) { return one.board == board; };
        if (std::any_of(asked_.begin(), asked_.end(), same)) return;
        auto& asked = asked_.emplace_back(Asked{board, std::nullopt, {}});
        // A stop is never too late.
        asked.call = session_.command(
            {.topic = topic(board), .payload = payload(), .deadline = environment_.timeout, .lasts = true},
            [&asked](const bus::Reply& reply) { asked.reply = reply; });
    }

    std::string topic(const std::string& board) const {
        return options_.resume ? environment_.topics.board_in(board) : environment_.topics.stop(board);
    }

    /// By patterns and labels: what is asked of a registry takes a moment.
    Outcome<void> stop_chosen(const std::string& pattern) {
        const auto boards = choose_boards(source_, {pattern, {}}, labels_);
        if (!boards) return tl::unexpected(boards.error());
        for (const auto& board : *boards)
            if (board.item.state != "offline" && !board.item.names_only) stop(board.item.board);
        return {};
    }

    Outcome<void> stop_all() {
        const auto boards = source_.boards({});
        if (!boards) return tl::unexpected(boards.error());
        // A lost one, too: its agent may be back before anybody knows.
        for (const auto& board : *boards)
            if (board.state != "offline" && !board.names_only) stop(board.board);
        return {};
    }

    int show() {
        int status = program::kExitOk;
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"BOARD"}, {"RESULT"}, {"EXECUTED", false, 10}, {"REFUSED", true}});
        for (const auto& asked : asked_) {
            const auto reply = asked.reply.value_or(not_waited_for());
            if (!reply.succeeded()) {
                environment_.note(note_of(asked.board, reply));
                if (status == program::kExitOk) status = exit_status(reply);
            }
            const auto done = done_of(reply.answer);
            if (!options_.output.for_people()) {
                auto record = *model::parse_json(bus::to_json_text(reply));
                record["board"] = asked.board;
                record.erase("answer");
                record["executed"] = done.executed;
                record["refused"] = done.refused;
                records.print(record);
                continue;
            }
            table.add(
                {asked.board,
                 reply.succeeded() ? Cell(done_text(done), Colour::kGreen)
                                   : Cell(options_.resume ? "not resumed" : "not stopped", Colour::kRed),
                 done.executed.empty() ? "-" : listed(done.executed, " "), std::to_string(done.refused)});
        }
        records.finish();
        if (options_.output.for_people())
            environment_.out << table.render(environment_.width, environment_.colour);
        return status;
    }

    /// An agent of an earlier version stops the board and does not keep it so.
    std::string done_text(const Done& done) const {
        if (options_.resume) return "resumed";
        return done.latched ? "stopped until resumed" : "stopped once";
    }

    const StopOptions& options_;
    const bus::LabelSelector labels_;
    std::list<Asked> asked_;
};

}  // namespace

int run_stop(const StopOptions& options, Environment& environment) {
    const std::string what = options.resume ? "resume" : "stop";
    if (options.boards.empty() && !options.all && !options.selector)
        return environment.fail_with(
            {program::kExitUsage, what + " which board? Write its name, a pattern, -l SELECTOR, or --all"});
    for (const auto& board : options.boards)
        if (!is_pattern(board) && !model::valid_board_name(board))
            return environment.fail_with({program::kExitUsage, model::explain_board_name(board)});
    auto labels = parse_selector(options.selector);
    if (!labels) return environment.fail_with(labels.error());
    return Stopper(options, std::move(*labels), environment).run();
}

namespace {

Run declare_stop(Declaration& verb) {
    auto options = std::make_shared<StopOptions>();
    verb.arguments("BOARD", options->boards, "Which boards; * and ? as in a shell", Declaration::Needed::kNo);
    declare_selector(verb, options->selector);
    verb.flag("--all", options->all, "Every board on the bus");
    verb.flag("--once", options->once, "Do not keep it stopped: later commands are executed again");
    verb.option("--why", "TEXT", options->why, "Told to those whose commands are refused");
    verb.output(options->output, {Output::kTable},
                {"board", "status", "executed", "refused", "error", "reason", "code"});
    return [options](Environment& environment) { return run_stop(*options, environment); };
}

}  // namespace

Verb stop_verb() {
    return {"stop", "Stop boards: motors, tones and other actuators, ahead of everything that waits",
            "The board stays stopped: its agent refuses the commands of every sender until asipctl resume; "
            "also after\n"
            "a restart of agent, board or broker. Questions and periods of reports pass. With --once later "
            "commands are executed again.\n"
            "Shows the requests that each board executed, and how many waiting commands were refused.\n"
            "Exit status: 0 all confirmed, 1 refused, 4 no confirmation.\n"
            "Examples:\n"
            "  asipctl stop robot\n"
            "  asipctl stop robot --why 'a child is on the track'\n"
            "  asipctl stop 'crane*' --once\n"
            "  asipctl stop -l room=lab\n"
            "  asipctl stop --all -o json",
            declare_stop};
}

}  // namespace asip::cli
