// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/ping.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/protocol/request.hpp"
#include "asip/text/duration.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/declaration.hpp"

namespace asip::cli {
namespace {

class Pinger {
  public:
    Pinger(const PingOptions& options, Environment& environment)
        : options_(options),
          environment_(environment),
          count_(options.count.value_or(environment.terminal() ? 0 : kPingsInScripts)),
          session_(environment),
          source_(environment, session_),
          records_(options.output, RecordPrinter::Count::kStream, environment.out) {
        summary_.board = options.board;
    }

    int run() {
        // A device with nothing but the published protocol answers on its context bus.
        const auto lines =
            session_.subscribe(environment_.topics.board_out(options_.board),
                               [this](const mqtt::Message& message) { take_line(message.payload); });
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        const auto board = find_living_board(source_, options_.board);
        if (!board) return environment_.fail_with(board.error());
        echo_ = board->description && board->description->firmware.extensions.has(protocol::kEcho);
        by_name_ = !board->description;
        while (!session_.stopped() && !denied_ && (count_ == 0 || summary_.sent < count_)) {
            const auto next = Clock::now() + options_.interval;
            once();
            const bool last = denied_ || (count_ != 0 && summary_.sent >= count_);
            if (!last) session_.run_until([] { return false; }, next);
        }
        if (options_.output.for_people()) {
            environment_.out << summary_.text() << std::flush;
        } else {
            records_.print(summary_.json());
        }
        if (!summary_.milliseconds.empty()) return program::kExitOk;
        if (denied_) return program::kExitFailure;
        return summary_.failed > 0 ? program::kExitFailure : session_.unanswered({}).status;
    }

  private:
    void once() {
        ++summary_.sent;
        token_ = "p" + std::to_string(summary_.sent % 10'000'000);
        const auto line = echo_ ? protocol::echo(token_) : std::string(protocol::kAskInfo);
        expected_ = echo_ ? "@#,E," + token_ : "@#,?,";
        std::optional<bus::Reply> reply;
        returned_.reset();
        const auto begin = Clock::now();
        const auto topic = environment_.topics.board_in(options_.board);
        // The first one is acknowledged by the broker: it tells whether we may.
        const int qos = summary_.sent == 1 ? 1 : 0;
        const auto request = session_.ask(
            topic, line,
            [&](const mqtt::Message& message) {
                if (auto parsed = bus::parse_reply(message.payload)) reply = std::move(*parsed);
                if (!returned_) returned_ = Clock::now();
            },
            qos, by_name_);
        session_.run_until([&] { return returned_.has_value() || session_.denied(topic); },
                           begin + environment_.timeout);
        denied_ = session_.denied(topic);
        if (session_.stopped() && !returned_) {
            --summary_.sent;
            return;
        }
        print(returned_ ? std::optional<Duration>(*returned_ - begin) : std::nullopt, reply);
    }

    void take_line(const std::string& line) {
        // An agent's acknowledgement is the proof; the line alone counts only where there is no agent.
        if (by_name_ && !returned_ && line.starts_with(expected_)) returned_ = Clock::now();
    }

    void print(std::optional<Duration> took, const std::optional<bus::Reply>& reply) {
        const bool answered = took && (!reply || reply->succeeded());
        std::string problem = took      ? ""
                              : denied_ ? "the broker does not let us ask"
                                        : "no answer within " + text::duration_text(environment_.timeout);
        if (took && !answered) {
            problem = explain(*reply);
            ++summary_.failed;
        }
        const double milliseconds = took ? std::chrono::duration<double, std::milli>(*took).count() : 0;
        if (answered) summary_.milliseconds.add(milliseconds);
        if (options_.quiet) return;
        if (options_.output.for_people()) {
            environment_.out << options_.board << ": seq=" << summary_.sent << ' '
                             << (answered ? fmt::format("time={:.2f} ms", milliseconds) : problem)
                             << std::endl;
            return;
        }
        nlohmann::json object{{"board", options_.board}, {"seq", summary_.sent}};
        if (answered) object["ms"] = milliseconds;
        if (!answered) object["problem"] = problem;
        records_.print(object);
    }

    const PingOptions& options_;
    Environment& environment_;
    std::size_t count_;
    BusSession session_;
    BoardSource source_;
    RecordPrinter records_;
    PingSummary summary_;
    bool echo_ = false;
    bool by_name_ = false;
    bool denied_ = false;
    std::string token_;
    std::string expected_;
    std::optional<Time> returned_;
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

int run_ping(const PingOptions& options, Environment& environment) {
    const auto target = parse_target(options.board);
    if (!target) return environment.fail_with(target.error());
    if (!target->service.empty())
        return environment.fail_with({program::kExitUsage, "ping takes a board, not a service"});
    return Pinger(options, environment).run();
}

namespace {

Run declare_ping(Declaration& verb) {
    auto options = std::make_shared<PingOptions>();
    verb.argument("BOARD", options->board, "Name of the board");
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
            "Examples:\n"
            "  asipctl ping uno1 -n 5\n"
            "  asipctl ping uno1 -n 1000 -i 0 -q",
            declare_ping};
}

}  // namespace asip::cli
