// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/top.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>

#include "asip/bus/pattern.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/program/options.hpp"
#include "asip/protocol/request.hpp"
#include "asip/text/duration.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/events/context_event.hpp"
#include "cli/events/stats_model.hpp"
#include "cli/events/top_model.hpp"
#include "cli/find/target.hpp"
#include "cli/terminal.hpp"
#include "cli/text/state_text.hpp"
#include "cli/text/terminal_buffer.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxPingsAtOnce = 50;
// As many as the trend shows.
constexpr double kDemandedHz = 2;
// A little more than the time between two documents of an agent.
constexpr Duration kFirstDocument = 17s;

class Top {
  public:
    Top(const TopOptions& options, Environment& environment)
        : options_(options), environment_(environment), session_(environment), model_(5s) {}

    int run() {
        session_.tell_refused_subscriptions();
        model_.sort_by(order_of(options_.sort));
        if (redraws_) session_.end_at_q();
        return options_.stats ? run_stats() : run_services();
    }

  private:
    int run_stats() {
        const auto take = [this](const mqtt::Message& message) {
            const auto topic = environment_.topics.parse(message.topic);
            if (!topic || message.retain || !wanted(std::string(topic->board))) return;
            stats_.take(std::string(topic->board), message.payload, Clock::now());
        };
        const auto documents = session_.subscribe(environment_.topics.stats("+"), take, {.retained = false});
        session_.on_connection_change(
            [this](bool connected, const std::string& why) { lost_ = connected ? "" : not_known_text(why); });
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        environment_.note("agents publish what they counted every 15 s");
        session_.run_until([this] { return !stats_.empty(); }, Clock::now() + kFirstDocument);
        for (std::size_t round = 0; !session_.stopped() && (options_.count == 0 || round < options_.count);
             ++round) {
            session_.run_for(options_.interval);
            show(stats_.records(Clock::now()), stats_.table(Clock::now()));
        }
        if (!stats_.empty() || session_.stopped() || options_.pattern == "*") return program::kExitOk;
        return environment_.fail_with({program::kExitNoAnswer, "no agent published what it counted of " +
                                                                   options_.pattern + "; see asipctl list"});
    }

    int run_services() {
        session_.on_board([this](const std::string& board, const mqtt::Message*) { look_at(board); });
        session_.caller().watch_all();
        const auto report = [this](const mqtt::Message& message) { take_report(message); };
        const auto reports =
            session_.subscribe(environment_.topics.service_out("+", "+"), report, {.retained = false});
        const auto errors =
            session_.subscribe(environment_.topics.service_error("+", "+"), report, {.retained = false});
        session_.on_connection_change(
            [this](bool connected, const std::string& why) { lost_ = connected ? "" : not_known_text(why); });
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        model_.begin(Clock::now());
        session_.publish(environment_.topics.probe(), "");
        const auto want = session_.want(options_.pattern, "*", kDemandedHz);
        for (std::size_t round = 0; !session_.stopped() && (options_.count == 0 || round < options_.count);
             ++round) {
            if (!options_.no_ping && lost_.empty()) ping_all();
            session_.run_for(options_.interval);
            missing_ = which_is_missing();
            if (redraws_ && session_.stopped()) break;
            show(options_.output.for_people() ? std::vector<nlohmann::json>() : model_.records(Clock::now()),
                 model_.table(Clock::now(), room()), model_.left_out());
        }
        return missing_ && !session_.stopped() ? environment_.fail_with(*missing_) : program::kExitOk;
    }

    std::optional<Failure> which_is_missing() const {
        const auto names = session_.boards().names();
        const auto is_it = [this](const std::string& name) { return wanted(name); };
        if (options_.pattern == "*" || std::any_of(names.begin(), names.end(), is_it)) return std::nullopt;
        return no_such_board(options_.pattern, names);
    }

    bool wanted(const std::string& board) const { return bus::matches_pattern(options_.pattern, board); }

    void look_at(const std::string& name) {
        if (!wanted(name)) return;
        const auto board = session_.boards().board(name, catalogue::instant_now());
        if (!board) return;
        model_.state(name, board->state);
        for (const auto& service : board->services)
            model_.announced(name, service.name, service.period);
    }

    void take_report(const mqtt::Message& message) {
        const auto event = context_event(environment_.topics, message.topic, message.payload);
        if (!event || !wanted(event->board) || message.retain) return;
        if (event->kind == ContextEvent::Kind::kError) {
            model_.error(event->board, event->service, Clock::now());
        } else {
            model_.value(event->board, event->service, event->payload, Clock::now());
        }
    }

    void ping_all() {
        std::size_t count = 0;
        for (const auto& [name, request] : pings_)
            model_.round_trip(name, std::nullopt);
        pings_.clear();
        for (const auto& board : session_.boards().boards({}, catalogue::instant_now())) {
            if (!wanted(board.board) || board.state != "online" || board.names_only ||
                ++count > kMaxPingsAtOnce)
                continue;
            const auto begin = Clock::now();
            const auto name = board.board;
            pings_[name] = session_.ask(environment_.topics.board_in(name), std::string(protocol::kAskInfo),
                                        [this, name, begin](const mqtt::Message& message) {
                                            const auto reply = bus::parse_reply(message.payload);
                                            pings_.erase(name);
                                            if (!reply || !reply->succeeded())
                                                return model_.round_trip(name, std::nullopt);
                                            model_.round_trip(name, Clock::now() - begin);
                                        });
        }
    }

    static TopModel::Order order_of(const std::string& word) {
        using Order = TopModel::Order;
        return word == "rate"     ? Order::kRate
               : word == "age"    ? Order::kAge
               : word == "errors" ? Order::kErrors
               : word == "trip"   ? Order::kTrip
                                  : Order::kName;
    }

    /// Rows of the table that the screen has, beside its head and what is said around it; 0: no limit.
    std::size_t room() const {
        const auto lines = redraws_ ? terminal_height(environment_.out_descriptor) : 0;
        constexpr std::size_t kOthers = 4;
        return lines == 0 ? 0 : std::max<std::size_t>(lines, kOthers + 1) - kOthers;
    }

    void show(const std::vector<nlohmann::json>& rows, Table table, std::size_t left_out = 0) {
        if (!options_.output.for_people()) {
            RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
            for (const auto& row : rows)
                records.print(row);
            records.finish();
            return;
        }
        // Home and clear: the table is drawn over itself.
        if (redraws_) environment_.out << own_control('\033') << "[H" << own_control('\033') << "[J";
        if (!lost_.empty()) environment_.say(lost_);
        if (missing_ && environment_.terminal()) environment_.say(missing_->text + "; waiting for it");
        environment_.out << table.render(environment_.width, environment_.colour);
        if (left_out > 0)
            environment_.out << left_out << " more; choose by a pattern, or --sort rate|age|errors|trip\n";
        if (!redraws_) environment_.out << '\n';
        environment_.out << std::flush;
    }

    const TopOptions& options_;
    Environment& environment_;
    bool redraws_ = environment_.terminal() && knows_escapes(program::environment_variable("TERM"));
    BusSession session_;
    TopModel model_;
    StatsModel stats_;
    std::map<std::string, BusSession::Request> pings_;  // those without an answer
    std::string lost_;
    std::optional<Failure> missing_;  // no board is what was asked for
};

}  // namespace

int run_top(const TopOptions& options, Environment& environment) {
    if (const auto valid = check_board_pattern(options.pattern, "top"); !valid)
        return environment.fail_with(valid.error());
    return Top(options, environment).run();
}

namespace {

Run declare_top(Declaration& verb) {
    auto options = std::make_shared<TopOptions>();
    verb.argument("PATTERN", options->pattern, "Only boards of this name; * and ? as in a shell",
                  Declaration::Needed::kNo);
    verb.option("-i,--interval", options->interval, "Between refreshes", 50ms);
    verb.option("-n,--count", "COUNT", options->count, "End after so many refreshes; 0: no limit");
    verb.option("--sort", "name|rate|age|errors|trip", options->sort,
                "What stands first: a name, or the highest of the others");
    verb.flag("--no-ping", options->no_ping, "Do not measure round trips");
    verb.flag("--stats", options->stats,
              "What agents counted since they started: lines, commands, round trips, losses");
    verb.output(
        options->output, {Output::kTable},
        {"board", "state", "round_trip_ms", "service", "rate", "age", "errors", "last", "uptime", "line",
         "commands", "round_trip", "queue", "holds", "stops", "bus", "number", "interval", "session"});
    return [options](Environment& environment) { return run_top(*options, environment); };
}

}  // namespace

Verb top_verb() {
    return {"top", "Live: rate, age, errors and round trip of each service",
            "On a terminal as many rows as fit; q ends it.\n"
            "Examples:\n"
            "  asipctl top\n"
            "  asipctl top 'uno*' -i 200ms\n"
            "  asipctl top --sort errors\n"
            "  asipctl top --stats\n"
            "  asipctl top -n 1 -o json",
            declare_top};
}

}  // namespace asip::cli
