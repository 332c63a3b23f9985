// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>

#include "asip/bus/pattern.hpp"
#include "asip/bus/registry/answer.hpp"
#include "asip/model/board_state.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/commands/list.hpp"
#include "cli/declaration.hpp"
#include "cli/events/log_printer.hpp"
#include "cli/find/target.hpp"
#include "cli/text/moment.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

/// One change of the catalogue, as `asipctl events` prints it.
bus::HistoryItem change_of(const bus::ChangeEvent& event) {
    bus::HistoryItem change;
    change.board = event.board.board;
    change.at = event.at;
    change.what = bus::to_string(event.kind);
    change.state = event.board.state;
    change.was = event.was;
    change.reason = event.reason;
    return change;
}

Table change_table() {
    return Table({{"TIME"}, {"BOARD"}, {"WHAT"}, {"STATE"}, {"BEFORE"}, {"REASON", false, 8}});
}

// "anna: servo {"write":[0,90]}, 12 times; queue-full"; "io {"write":[5,1]}, by link warm, because
// desk/temperature was 30.5"
std::string command_words(const bus::HistoryItem& command) {
    const bool link = command.by.starts_with("link ");
    std::string words = link ? std::string() : command.by + ":";
    for (const auto& part : {command.service, command.request})
        if (!part.empty()) words += (words.empty() ? "" : " ") + part;
    if (link) words += ", by " + command.by;
    if (command.count > 1) words += ", " + std::to_string(command.count) + " times";
    return command.reason.empty() ? words : words + "; " + command.reason;
}

std::string reason_words(const std::string& reason) {
    const auto words = model::words_of(model::state_reason_from_text(reason));
    return words.empty() ? reason : std::string(words);
}

std::vector<Cell> change_row(const bus::HistoryItem& change) {
    if (change.is_command())
        return {text::iso_time(change.at), change.board, change.what, change.status, "",
                command_words(change)};
    return {text::iso_time(change.at),
            change.board,
            change.what,
            Cell(change.state, state_colour(change.state)),
            change.was,
            reason_words(change.reason)};
}

/// Names that a template may use: members of bus::to_json(HistoryItem).
std::vector<std::string> change_fields() {
    return {"board", "at", "what", "state", "was", "reason", "by", "service", "request", "status", "count"};
}

using namespace std::chrono_literals;

struct EventsOptions {
    std::string pattern = "*";
    std::size_t count = 0;
    std::optional<std::chrono::milliseconds> limit{};
    std::string since;                  ///< how long ago, or a time; empty: from now on
    std::optional<std::size_t> last{};  ///< only what a registry has kept
    bool logs = false;
    OutputOptions output{Output::kTable, {}};
};

/// More are not asked of a registry at once.
constexpr std::size_t kMaxChanges = 100'000;

Outcome<text::WallTime> since_time(const std::string& text) {
    if (text.empty()) return text::WallTime{};
    const auto moment = parse_moment(text, text::wall_now());
    if (!moment) return failure(program::kExitUsage, "--since: " + moment.error());
    return *moment;
}

/// Prints changes as they come, of a registry or, without one, as the bus itself shows them.
class Follower : OnTheBus {
  public:
    /// `since`: 1970 for what comes from now on.
    Follower(const EventsOptions& options, text::WallTime since, Environment& environment)
        : OnTheBus(environment),
          options_(options),
          since_(since),
          records_(options.output, RecordPrinter::Count::kStream, environment.out) {}

    int run() {
        session_.tell_refused_subscriptions();
        if (const auto status = connect()) return *status;
        const auto registry = source_.find_registry();
        if (session_.stopped()) return program::kExitOk;
        if (registry.empty() && since_ != text::WallTime{})
            return environment_.fail_with(
                {program::kExitNoAnswer,
                 "--since needs a registry with a history: asip-registry --history FILE"});
        if (registry.empty()) {
            follow_bus();
        } else {
            follow_registry(registry);
            const auto kept = print_kept();
            if (session_.stopped()) return program::kExitOk;
            if (!kept) return environment_.fail_with(kept.error());
        }
        const auto deadline = options_.limit ? Clock::now() + *options_.limit : Time::max();
        while (!session_.stopped() && !enough() && Clock::now() < deadline)
            session_.run_until([this] { return enough(); }, std::min(deadline, Clock::now() + 1h));
        return options_.limit && count_ == 0 && !session_.stopped() ? program::kExitNoAnswer
                                                                    : program::kExitOk;
    }

  private:
    bool enough() const { return options_.count != 0 && count_ >= options_.count; }

    void follow_registry(const std::string& registry) {
        subscriptions_.push_back(session_.subscribe(
            environment_.topics.registry_events(registry), [this](const mqtt::Message& message) {
                const auto event = bus::parse_change_event(message.payload);
                if (!event || event->kind == bus::ChangeEvent::Kind::kReset) return;
                auto change = change_of(*event);
                if (reading_)
                    meanwhile_.push_back(std::move(change));
                else
                    print(change);
            }));
    }

    /// What the registry kept since then, and what came while it was read: each once.
    Outcome<void> print_kept() {
        if (since_ == text::WallTime{}) return {};
        reading_ = true;
        bus::Query query;
        query.board = options_.pattern;
        auto kept = source_.history(query, kMaxChanges, since_);
        reading_ = false;
        if (!kept) return tl::unexpected(kept.error());
        std::reverse(kept->begin(), kept->end());
        for (const auto& change : *kept)
            print(change);
        for (const auto& change : meanwhile_) {
            const auto same = [&change](const bus::HistoryItem& one) {
                return one.at == change.at && one.board == change.board && one.what == change.what;
            };
            if (std::none_of(kept->begin(), kept->end(), same)) print(change);
        }
        meanwhile_.clear();
        return {};
    }

    void follow_bus() {
        session_.on_board([this](const std::string& board, const mqtt::Message*) { look_at(board); });
        session_.caller().watch_all();
        retained_.emplace(session_.mark_retained());
    }

    /// What was there before the first look is not a change.
    void look_at(const std::string& name) {
        const auto board = session_.boards().board(name, catalogue::instant_now());
        const auto state = board ? board->state : std::string();
        const auto known = states_.find(name);
        const auto was = known == states_.end() ? std::string() : known->second;
        if (state == was) return;
        states_[name] = state;
        if (!retained_ || !retained_->passed()) return;
        bus::HistoryItem change;
        change.board = name;
        change.at = text::wall_now();
        change.what = was.empty() ? "added" : state.empty() ? "forgotten" : "state";
        change.state = state;
        change.was = was;
        if (board) change.reason = board->reason;
        print(change);
    }

    void print(const bus::HistoryItem& change) {
        if (enough() || !bus::matches_pattern(options_.pattern, change.board)) return;
        ++count_;
        if (!options_.output.for_people()) {
            records_.print(bus::to_json(change));
            return;
        }
        table_.add(change_row(change));
        environment_.out << (count_ == 1 ? table_.render(environment_.width, environment_.colour)
                                         : table_.render_more(environment_.width, environment_.colour))
                         << std::flush;
    }

    const EventsOptions& options_;
    text::WallTime since_;
    bool reading_ = false;
    std::vector<bus::HistoryItem> meanwhile_;
    RecordPrinter records_;
    Table table_ = change_table();
    std::map<std::string, std::string> states_;
    std::vector<BusSession::Subscription> subscriptions_;
    std::optional<BusSession::Mark> retained_;  // passed: what comes now is new
    std::size_t count_ = 0;
};

void print_changes(const std::vector<bus::HistoryItem>& changes, const OutputOptions& output,
                   Environment& environment) {
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    auto table = change_table();
    for (const auto& change : changes)
        if (output.for_people())
            table.add(change_row(change));
        else
            records.print(bus::to_json(change));
    if (!output.for_people()) return records.finish();
    if (table.empty()) return environment.note("nothing is known of it");
    environment.out << table.render(environment.width, environment.colour) << std::flush;
}

int print_last(const EventsOptions& options, Environment& environment) {
    bus::Query query;
    if (options.pattern != "*") query.board = options.pattern;
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    auto changes = source.history(query, *options.last);
    if (!changes) return environment.fail_with(changes.error());
    if (changes->empty() && !query.board.empty()) {
        const auto names = source.names();
        const auto is_it = [&](const std::string& name) { return bus::matches_pattern(query.board, name); };
        if (std::none_of(names.begin(), names.end(), is_it))
            return environment.fail_with(no_such_board(query.board, names));
    }
    // A registry gives the newest first.
    std::reverse(changes->begin(), changes->end());
    print_changes(*changes, options.output, environment);
    return program::kExitOk;
}

std::string contradiction(const EventsOptions& options) {
    if (options.last && (*options.last == 0 || *options.last > kMaxChanges))
        return "--last: a number from 1 to 100000";
    if (options.last && (options.logs || options.limit || !options.since.empty() || options.count != 0))
        return "--last goes alone: it prints what a registry has kept, and ends";
    if (options.logs && !options.since.empty())
        return "nothing is kept of --logs: --since does not go with it";
    return {};
}

int run_events(const EventsOptions& options, Environment& environment) {
    if (const auto wrong = contradiction(options); !wrong.empty())
        return environment.fail_with({program::kExitUsage, wrong});
    if (const auto valid = check_board_pattern(options.pattern, "events"); !valid)
        return environment.fail_with(valid.error());
    if (options.logs)
        return run_logs({options.pattern, options.count, options.limit, options.output}, environment);
    if (options.last) return print_last(options, environment);
    const auto since = since_time(options.since);
    return since ? Follower(options, *since, environment).run() : environment.fail_with(since.error());
}

Run declare_events(Declaration& verb) {
    auto options = std::make_shared<EventsOptions>();
    verb.argument("PATTERN", options->pattern, "Only boards of this name; * and ? as in a shell",
                  Declaration::Needed::kNo);
    verb.option("-n,--count", "COUNT", options->count, "End after so many; 0: no limit");
    verb.option("-W,--for", options->limit, "End after this time; status 4 when too few came");
    verb.option("--last", "COUNT", options->last, "The newest so many that a registry has kept, no new ones");
    verb.flag("--logs", options->logs,
              "What boards print for people, their errors, and what their agents log");
    verb.option("--since", "WHEN", options->since,
                "Begin with what a registry has kept since then: 10m, 12h, or a time in UTC");
    auto fields = change_fields();
    fields.insert(fields.end(), {"time", "source", "level", "text"});
    verb.output(options->output, {Output::kTable}, fields);
    return [options](Environment& environment) { return run_events(*options, environment); };
}

}  // namespace

Verb events_verb() {
    return {"events", "What boards do: they come, leave, change and log; now, or what a registry kept",
            "From a registry, which says why; without one, what the bus itself shows. What was before, with "
            "the user of each\n"
            "command, is known by a registry with a history: asip-registry --history FILE.\n"
            "Examples:\n"
            "  asipctl events\n"
            "  asipctl events uno1 --last 20\n"
            "  asipctl events --since 1h -W 0\n"
            "  asipctl events uno1 --logs\n"
            "  asipctl events 'uno*' -o jsonl\n"
            "  asipctl events -n 1 -W 1m --format '{board} is {state}'",
            declare_events};
}

}  // namespace asip::cli
