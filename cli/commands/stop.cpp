// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/stop.hpp"

#include <algorithm>
#include <cstdint>
#include <list>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/declaration.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

class Stopper {
  public:
    Stopper(const StopOptions& options, Environment& environment)
        : options_(options),
          environment_(environment),
          session_(environment),
          source_(environment, session_) {}

    int run() {
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        // Named ones at once: looking them up first would cost time.
        for (const auto& board : options_.boards)
            stop(board);
        if (options_.all)
            if (const auto found = stop_all(); !found) return environment_.fail_with(found.error());
        if (asked_.empty()) {
            environment_.note("there is no board to stop");
            return program::kExitOk;
        }
        const auto settled = [this](const Asked& asked) { return asked.reply || denied(asked); };
        session_.run_until([&] { return std::all_of(asked_.begin(), asked_.end(), settled); },
                           Clock::now() + environment_.timeout);
        return show();
    }

  private:
    struct Asked {
        std::string board;
        std::optional<bus::Reply> reply;
        BusSession::Request request;
    };

    /// The agent's answer that the board did not confirm is to come before the end of our patience.
    std::string payload() const {
        const auto deadline = std::clamp<std::int64_t>(environment_.timeout.count() * 9 / 10, 50, 60000);
        return nlohmann::json{{"deadline_ms", deadline}}.dump();
    }

    void stop(const std::string& board) {
        const auto same = [&board](const Asked& one) { return one.board == board; };
        if (std::any_of(asked_.begin(), asked_.end(), same)) return;
        auto& asked = asked_.emplace_back(Asked{board, std::nullopt, {}});
        asked.request = session_.ask(
            environment_.topics.stop(board), payload(),
            [&asked](const mqtt::Message& message) {
                if (asked.reply) return;
                const auto reply = bus::parse_reply(message.payload);
                if (reply) asked.reply = *reply;
            },
            1);
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
            const auto reply = reply_of(asked);
            if (!reply.succeeded()) {
                environment_.note(asked.board + ": " + why_not(reply));
                if (status == program::kExitOk)
                    status = reply.reason == kNoAnswer ? session_.unanswered({}).status : exit_status(reply);
            }
            const auto answer = model::parse_json(reply.answer).value_or(nlohmann::json::object());
            if (!options_.output.for_people()) {
                auto record = *model::parse_json(bus::to_json_text(reply));
                record["board"] = asked.board;
                record.erase("answer");
                record["executed"] = answer.value("executed", nlohmann::json::array());
                record["refused"] = answer.value("refused", 0);
                records.print(record);
                continue;
            }
            std::string executed;
            for (const auto& line : answer.value("executed", nlohmann::json::array()))
                executed += (executed.empty() ? "" : " ") + line.get<std::string>();
            table.add(
                {asked.board,
                 reply.succeeded() ? Cell("stopped", Colour::kGreen) : Cell("not stopped", Colour::kRed),
                 executed.empty() ? "-" : executed, std::to_string(answer.value("refused", 0))});
        }
        records.finish();
        if (options_.output.for_people())
            environment_.out << table.render(environment_.width, environment_.colour);
        return status;
    }

    bool denied(const Asked& asked) const { return session_.denied(environment_.topics.stop(asked.board)); }

    bus::Reply reply_of(const Asked& asked) const {
        if (asked.reply) return *asked.reply;
        return denied(asked) ? refused_by_broker(environment_.topics.stop(asked.board))
                             : bus::Reply::timeout(std::string(kNoAnswer));
    }

    std::string why_not(const bus::Reply& reply) const {
        if (reply.reason == kNoAnswer)
            return session_
                .unanswered("nobody answered within " + std::to_string(environment_.timeout.count()) +
                            " ms; is the board's agent running? Try: asipctl doctor")
                .text;
        return reply.error.empty() ? explain(reply) : reply.error;
    }

    const StopOptions& options_;
    Environment& environment_;
    BusSession session_;
    BoardSource source_;
    std::list<Asked> asked_;
};

}  // namespace

int run_stop(const StopOptions& options, Environment& environment) {
    if (options.boards.empty() && !options.all)
        return environment.fail_with({program::kExitUsage, "stop which board? Write its name, or --all"});
    for (const auto& board : options.boards)
        if (!model::valid_board_name(board))
            return environment.fail_with({program::kExitUsage, model::explain_board_name(board)});
    return Stopper(options, environment).run();
}

namespace {

Run declare_stop(Declaration& verb) {
    auto options = std::make_shared<StopOptions>();
    verb.arguments("BOARD", options->boards, "Which boards", Declaration::Needed::kNo);
    verb.flag("--all", options->all, "Every board on the bus");
    verb.output(options->output, {Output::kTable},
                {"board", "status", "executed", "refused", "error", "reason", "code"});
    return [options](Environment& environment) { return run_stop(*options, environment); };
}

}  // namespace

Verb stop_verb() {
    return {"stop", "Stop boards: motors, tones and other actuators, ahead of everything that waits",
            "Shows the requests that each board executed, and how many waiting commands were refused. "
            "Commands that are sent later are executed again.\n"
            "Exit status: 0 all confirmed, 1 refused, 4 no confirmation.\n"
            "Examples:\n"
            "  asipctl stop robot\n"
            "  asipctl stop robot crane\n"
            "  asipctl stop --all -o json",
            declare_stop};
}

}  // namespace asip::cli
