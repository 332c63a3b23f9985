// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/ping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/protocol/request.hpp"
#include "asip/text/duration.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/side_by_side.hpp"
#include "cli/declaration.hpp"

namespace asip::cli {
namespace {

class Pinger : OnTheBus {
  public:
    Pinger(const PingOptions& options, Environment& environment)
        : OnTheBus(environment),
          options_(options),
          count_(options.count.value_or(environment.terminal() ? 0 : kPingsInScripts)),
          records_(options.output, RecordPrinter::Count::kStream, environment.out) {}

    int run(const Target& target, const std::optional<bus::LabelSelector>& labels) {
        if (const auto status = connect()) return *status;
        const auto found = labels ? find_group(target, *labels) : find_one();
        if (!found) return environment_.fail_with(found.error());
        std::size_t round = 0;
        while (!session_.stopped() && someone_may_be_asked() && (count_ == 0 || round < count_)) {
            const auto next = Clock::now() + options_.interval;
            once(++round);
            const bool last = !someone_may_be_asked() || (count_ != 0 && round >= count_);
            if (!last) session_.run_until([] { return false; }, next);
        }
        print_summaries(labels.has_value());
        return status();
    }

  private:
    /// One of the boards.
    struct Pinged {
        PingSummary summary;
        bool echo = false;
        bool by_name = false;
        bool denied = false;
        std::string expected{};
        std::optional<bus::Reply> reply{};
        Time begin{};
        std::optional<Time> returned{};
        BusSession::Subscription lines{};
        BusSession::Request request{};

        const std::string& name() const { return summary.board; }
    };

    Outcome<void> find_one() {
        const auto board = find_living_board(source_, options_.board);
        if (!board) return tl::unexpected(board.error());
        add(*board);
        return {};
    }

    Outcome<void> find_group(const Target& target, const bus::LabelSelector& labels) {
        const auto boards = choose_boards(source_, target, labels);
        if (!boards) return tl::unexpected(boards.error());
        std::string away;
        for (const auto& board : *boards) {
            const bool is_away = model::is_gone(board.item.state);
            if (is_away)
                away += (away.empty() ? "" : ", ") + board.item.board + " is " + board.item.state;
            else
                add(board);
        }
        if (!away.empty()) environment_.note("left out: " + away);
        left_out_ = !away.empty();
        if (boards_.empty()) return failure(program::kExitNoAnswer, "none of these boards is there");
        return {};
    }

    void add(const KnownBoard& board) {
        auto& pinged = boards_.emplace_back();
        pinged.summary.board = board.item.board;
        pinged.echo = board.description && board.description->firmware.extensions.has(protocol::kEcho);
        pinged.by_name = !board.description;
        if (!pinged.by_name) return;
        // A device with nothing but the published protocol answers on its context bus. An agent's
        // acknowledgement is the proof where there is an agent.
        pinged.lines = session_.subscribe(
            environment_.topics.board_out(pinged.name()), [&pinged](const mqtt::Message& message) {
                if (!pinged.returned && message.payload.starts_with(pinged.expected))
                    pinged.returned = Clock::now();
            });
    }

    bool someone_may_be_asked() const {
        return std::any_of(boards_.begin(), boards_.end(), [](const Pinged& one) { return !one.denied; });
    }

    void once(std::size_t round) {
        std::list<Pinged*> asked;
        for (auto& board : boards_)
            if (!board.denied) asked.push_back(&board);
        std::list<Pinged*> printed = asked;
        ask_side_by_side(
            session_, std::move(asked), kAskedAtOnce, [this, round](Pinged& one) { return ask(one, round); },
            [this](const Pinged& one) {
                return one.returned.has_value() || session_.denied(environment_.topics.board_in(one.name()));
            });
        for (auto* one : printed)
            take_result(*one, round);
    }

    Time ask(Pinged& one, std::size_t round) {
        ++one.summary.sent;
        const auto token = "p" + std::to_string(round % 10'000'000);
        const auto line = one.echo ? protocol::echo(token) : std::string(protocol::kAskInfo);
        one.expected = one.echo ? "@#,E," + token : "@#,?,";
        one.reply.reset();
        one.returned.reset();
        one.begin = Clock::now();
        // The first one is acknowledged by the broker: it tells whether we may.
        const int qos = round == 1 ? 1 : 0;
        one.request = session_.ask(
            environment_.topics.board_in(one.name()), line,
            [&one](const mqtt::Message& message) {
                if (auto parsed = bus::parse_reply(message.payload)) one.reply = std::move(*parsed);
                if (!one.returned) one.returned = Clock::now();
            },
            qos, one.by_name);
        return one.begin + environment_.timeout;
    }

    void take_result(Pinged& one, std::size_t round) {
        if (one.summary.sent < round) return;  // the user ended it before
        one.denied = session_.denied(environment_.topics.board_in(one.name()));
        one.request.reset();
        if (session_.stopped() && !one.returned) {
            --one.summary.sent;
            return;
        }
        print(one, one.returned ? std::optional<Duration>(*one.returned - one.begin) : std::nullopt);
    }

    void print(Pinged& one, std::optional<Duration> took) {
        const bool answered = took && (!one.reply || one.reply->succeeded());
        std::string problem = took         ? ""
                              : one.denied ? "the broker does not let us ask"
                                           : "no answer within " + text::duration_text(environment_.timeout);
        if (took && !answered) {
            problem = bus::sentence_of(*one.reply);
            ++one.summary.failed;
        }
        const double milliseconds = took ? std::chrono::duration<double, std::milli>(*took).count() : 0;
        if (answered) one.summary.milliseconds.add(milliseconds);
        if (options_.quiet) return;
        if (options_.output.for_people()) {
            return environment_.say(
                fmt::format("{}: seq={} {}", one.name(), one.summary.sent,
                            answered ? fmt::format("time={:.2f} ms", milliseconds) : problem));
        }
        nlohmann::json object{{"board", one.name()}, {"seq", one.summary.sent}};
        if (answered) object["ms"] = milliseconds;
        if (!answered) object["problem"] = problem;
        records_.print(object);
    }

    void print_summaries(bool group) {
        if (!options_.output.for_people()) {
            for (const auto& one : boards_)
                records_.print(one.summary.json());
        } else if (group) {
            if (!options_.quiet) environment_.out << '\n';
            Table table({{"BOARD"},
                         {"SENT", true},
                         {"ANSWERED", true},
                         {"MINIMUM", true},
                         {"P50", true},
                         {"P99", true},
                         {"MAXIMUM", true}});
            for (const auto& one : boards_)
                table.add(one.summary.cells());
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        } else {
            environment_.out << boards_.front().summary.text() << std::flush;
        }
    }

    /// Whether each board answered at least once.
    int status() const {
        int status = program::kExitOk;
        for (const auto& one : boards_) {
            if (!one.summary.milliseconds.empty() || status != program::kExitOk) continue;
            status =
                one.denied || one.summary.failed > 0 ? program::kExitFailure : session_.unanswered({}).status;
        }
        return status == program::kExitOk && left_out_ ? program::kExitFailure : status;
    }

    const PingOptions& options_;
    std::size_t count_;
    RecordPrinter records_;
    std::list<Pinged> boards_;
    bool left_out_ = false;
};

}  // namespace

double PingSummary::loss_percent() const {
    return sent == 0 ? 0
                     : 100.0 * static_cast<double>(sent - milliseconds.size()) / static_cast<double>(sent);
}

std::string PingSummary::text() const {
    auto text = fmt::format("\n{}: {} sent, {} answered, {:.0f} % lost\n", board, sent, milliseconds.size(),
                            loss_percent());
    if (milliseconds.empty()) return text;
    return text + fmt::format("round trip: minimum {:.2f}, p50 {:.2f}, p99 {:.2f}, maximum {:.2f} ms\n",
                              milliseconds.minimum(), milliseconds.percentile(50),
                              milliseconds.percentile(99), milliseconds.maximum());
}

nlohmann::json PingSummary::json() const {
    nlohmann::json object{{"board", board},
                          {"sent", sent},
                          {"answered", milliseconds.size()},
                          {"loss_percent", loss_percent()}};
    if (!milliseconds.empty()) {
        object["ms"] = {{"minimum", milliseconds.minimum()},
                        {"p50", milliseconds.percentile(50)},
                        {"p99", milliseconds.percentile(99)},
                        {"maximum", milliseconds.maximum()}};
    }
    return object;
}

std::vector<Cell> PingSummary::cells() const {
    std::vector<Cell> row{
        board, std::to_string(sent),
        Cell(std::to_string(milliseconds.size()), milliseconds.size() < sent ? Colour::kRed : Colour::kNone)};
    if (milliseconds.empty()) return row;
    for (const auto value : {milliseconds.minimum(), milliseconds.percentile(50), milliseconds.percentile(99),
                             milliseconds.maximum()})
        row.push_back(fmt::format("{:.2f} ms", value));
    return row;
}

int run_ping(const PingOptions& options, Environment& environment) {
    const auto target = parse_target(options.board, true);
    if (!target) return environment.fail_with(target.error());
    const auto labels = parse_selector(options.selector);
    if (!labels) return environment.fail_with(labels.error());
    if (!target->service.empty())
        return environment.fail_with({program::kExitUsage, "ping takes a board, not a service"});
    const bool many = options.selector || target->is_pattern();
    return Pinger(options, environment).run(*target, many ? std::optional(*labels) : std::nullopt);
}

namespace {

Run declare_ping(Declaration& verb) {
    auto options = std::make_shared<PingOptions>();
    verb.argument("BOARD", options->board,
                  "Name of the board; with * and ? as in a shell, or with -l: several boards");
    declare_selector(verb, options->selector);
    verb.option(
        "-n,-c,--count", "COUNT", options->count,
        "End after so many; 0: until Ctrl-C, which is the default on a terminal; else the default is 5");
    verb.option("-i,--interval", options->interval, "From one to the next");
    verb.flag("-q,--quiet", options->quiet, "Only the summary");
    verb.output(options->output, {Output::kText},
                {"board", "seq", "ms", "problem", "sent", "answered", "loss_percent"});
    return [options](Environment& environment) { return run_ping(*options, environment); };
}

}  // namespace

Verb ping_verb() {
    return {"ping", "Round trip to the board itself, through broker, agent and link",
            "Exit status: 0 when at least one was answered, 4 when none was, 1 when the board or the broker "
            "refused.\n"
            "Several boards are asked at the same time; 0 only where each of them answered.\n"
            "Examples:\n"
            "  asipctl ping uno1 -n 5\n"
            "  asipctl ping uno1 -n 1000 -i 0 -q\n"
            "  asipctl ping '*' -n 10 -q -l room=lab",
            declare_ping};
}

}  // namespace asip::cli
