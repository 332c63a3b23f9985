// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/subscribe.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>

#include "asip/bus/registry/board_match.hpp"
#include "cli/ask/described_properties.hpp"
#include "cli/declaration.hpp"
#include "cli/events/button_events.hpp"
#include "cli/events/context_event.hpp"
#include "cli/events/event_pace.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

Outcome<std::vector<Target>> parse_targets(const std::vector<std::string>& texts) {
    std::vector<Target> result;
    for (const auto& text : texts) {
        auto target = parse_target(text, true);
        if (!target) return tl::unexpected(target.error());
        result.push_back(std::move(*target));
    }
    return result;
}

std::string value_of(const SeenEvent& seen, std::string_view name) {
    const auto& leaves = seen.decoded.leaves;
    if (name == "text") return seen.decoded.text;
    if (name == "field") return seen.decoded.field;
    if (name == "unit") return leaves.empty() ? std::string() : leaves.front().unit;
    if (name != "value") return event_value(seen.event, name);
    return listed(leaves, ", ", [](const auto& leaf) { return LeafValue{leaf.path, leaf.value, {}}.text(); });
}

/// With --field the selection stands beside the whole report.
nlohmann::json record(const SeenEvent& seen) {
    auto object = event_json(seen.event);
    const auto& leaves = seen.decoded.leaves;
    if (leaves.empty()) return object;
    object["field"] = seen.decoded.field;
    if (!leaves.front().unit.empty()) object["unit"] = leaves.front().unit;
    if (leaves.size() == 1)
        object["value"] = leaves.front().value;
    else
        for (const auto& leaf : leaves)
            object["value"][leaf.path] = leaf.value;
    return object;
}

std::vector<std::string> seen_fields() {
    auto fields = event_fields();
    fields.insert(fields.end(), {"text", "field", "value", "unit"});
    return fields;
}

class EventPrinter {
  public:
    EventPrinter(const SubscribeOptions& options, Environment& environment)
        : options_(options),
          environment_(environment),
          records_(options.output, RecordPrinter::Count::kStream, environment.out) {
        // Checked when the command line was read.
        if (!options.output.format.empty()) template_ = *LineTemplate::parse(options.output.format);
    }

    void print(const SeenEvent& seen) {
        if (template_) {
            environment_.out << template_->fill([&](std::string_view name) { return value_of(seen, name); })
                             << std::endl;
        } else if (!options_.output.for_people()) {
            records_.print(record(seen));
        } else {
            if (environment_.terminal() && !std::exchange(headed_, true))
                environment_.out << event_header(options_.time, options_.age, environment_.colour) << '\n';
            environment_.out << event_text(seen.event, seen.decoded.text, options_.time, options_.age,
                                           environment_.colour)
                             << std::endl;
        }
    }

  private:
    const SubscribeOptions& options_;
    Environment& environment_;
    RecordPrinter records_;
    std::optional<LineTemplate> template_;
    bool headed_ = false;
};

/// Takes what comes, keeps what is wanted and prints it.
class Subscriber {
  public:
    Subscriber(const SubscribeOptions& options, std::vector<Target> targets, bus::LabelSelector labels,
               Environment& environment, BusSession& session)
        : options_(options),
          environment_(environment),
          session_(session),
          targets_(std::move(targets)),
          labels_(std::move(labels)),
          printer_(options, environment),
          pace_(options.changes, options.max_hz),
          buttons_(environment.topics),
          properties_(session, environment) {}

    void subscribe() {
        // First: they attribute lines and letters to services, and name models.
        for (const auto& boards : described()) {
            session_.caller().watch_description(boards);
            if (labels_.empty()) continue;
            subscriptions_.push_back(session_.subscribe(
                environment_.topics.description(boards), [this](const mqtt::Message& message) {
                    if (const auto topic = environment_.topics.parse(message.topic))
                        demand_of_chosen(std::string(topic->board));
                }));
        }
        if (labels_.empty() && !options_.no_demand)
            for (const auto& target : targets_)
                demands_.push_back(session_.demand(target.board, target.service, wanted_hz()));
        for (const auto& filter : context_filters(environment_.topics, targets_, options_.raw)) {
            subscriptions_.push_back(
                session_.subscribe(filter, [this](const mqtt::Message& message) { take(message); }));
        }
        if (options_.raw || !options_.field.empty()) return;
        std::set<std::string> values;
        for (const auto& target : targets_)
            values.insert(environment_.topics.values(target.is_pattern() ? "+" : target.board));
        for (const auto& filter : values)
            subscriptions_.push_back(session_.subscribe(filter, [this](const mqtt::Message& message) {
                for (auto& event : buttons_.take(message))
                    take(std::move(event));
            }));
    }

    bool enough() const { return options_.count != 0 && count_ >= options_.count; }
    std::size_t count() const { return count_; }
    /// Prints what --max-hz has held back for long enough.
    void print_due() {
        for (const auto& seen : pace_.due(Clock::now()))
            print(seen);
    }

  private:
    /// For a pattern only where it cannot be done without: they may be thousands.
    std::set<std::string> described() const {
        std::set<std::string> boards;
        for (const auto& target : targets_)
            if (needs_description(target, options_.raw) || !labels_.empty() ||
                (!options_.raw && !target.is_pattern()))
                boards.insert(target.is_pattern() ? "+" : target.board);
        return boards;
    }

    double wanted_hz() const { return options_.max_hz > 0 ? options_.max_hz : bus::kUsualHz; }

    /// Labels come and go.
    void demand_of_chosen(const std::string& board) {
        if (options_.no_demand) return;
        if (!is_chosen(board)) {
            wants_.erase(board);
            return;
        }
        auto& wants = wants_[board];
        for (const auto& target : targets_)
            if (wants.size() < targets_.size())
                wants.push_back(target.matches(board, target.service)
                                    ? session_.want(board, target.service, wanted_hz())
                                    : nullptr);
    }

    model::ModelPtr model_of(const ContextEvent& event) const {
        if (event.kind != ContextEvent::Kind::kValue) return nullptr;
        if (const auto* description = session_.boards().description(event.board)) {
            for (const auto& service : description->services)
                if (service.name == event.service) return bus::model_of(service, environment_.models());
        }
        // A service is named by its model.
        return environment_.models().find(event.service);
    }

    /// Models are parsed when first asked for, which takes longer than `-o jsonl` may.
    bool needs_models() const {
        return options_.output.for_people() || !options_.output.format.empty() || !options_.field.empty();
    }

    void print(const SeenEvent& seen) {
        if (enough()) return;
        printer_.print(seen);
        ++count_;
    }

    bool is_chosen(const std::string& board) const {
        if (labels_.empty()) return true;
        const auto* description = session_.boards().description(board);
        return description != nullptr && labels_.matches(description->labels.labels);
    }

    void take(const mqtt::Message& message) {
        auto event = context_event(environment_.topics, message.topic, message.payload);
        if (!event) return;
        event->retained = message.retain;
        take(std::move(*event));
    }

    void take(ContextEvent event) {
        if (enough() || !is_wanted(event, targets_, session_.boards().description(event.board))) return;
        if (!is_chosen(event.board)) return;
        event.time = std::chrono::system_clock::now();
        const auto now = Clock::now();
        auto& last = last_[event.topic];
        if (last) event.age = now - *last;
        last = now;
        const auto model = needs_models() ? model_of(event) : nullptr;
        auto decoded =
            decode_event(event, model.get(), model ? properties_.of(event.board) : DescribedProperties::kNone,
                         options_.field);
        if (!decoded) return;
        if (const auto seen = pace_.offer({std::move(event), std::move(*decoded)}, now)) print(*seen);
    }

    const SubscribeOptions& options_;
    Environment& environment_;
    BusSession& session_;
    std::vector<Target> targets_;
    bus::LabelSelector labels_;
    EventPrinter printer_;
    EventPace pace_;
    std::map<std::string, std::optional<Time>> last_;
    ButtonEvents buttons_;
    DescribedProperties properties_;
    std::size_t count_ = 0;
    std::vector<BusSession::Subscription> subscriptions_;
    std::vector<BusSession::Demand> demands_;
    std::map<std::string, std::vector<bus::Demander::Want>> wants_;  // with labels: of the boards chosen
};

/// A name that no board has is reported at once, but one may still come.
void note_unknown(const std::vector<Target>& targets, const bus::LabelSelector& labels,
                  Environment& environment, BoardSource& source) {
    for (const auto& target : targets) {
        if (!labels.empty()) {
            const auto boards = choose_boards(source, target, labels);
            if (!boards && boards.error().text == kInterrupted) return;
            if (!boards) environment.note(boards.error().text + "; waiting for one");
            continue;
        }
        if (target.is_pattern()) continue;
        const auto board = source.board(target.board);
        if (!board && board.error().text == kInterrupted) return;
        if (!board) {
            environment.note(board.error().text + "; waiting for it");
            continue;
        }
        if (!target.service.empty() && board->description) {
            if (const auto service = find_service(*board, target.service); !service)
                environment.note(service.error().text);
        }
        if (board->item.state != "online")
            environment.note(target.board + " is " + board->item.state + "; waiting for it");
    }
}

}  // namespace

int run_subscribe(const SubscribeOptions& options, Environment& environment) {
    if (options.targets.empty() && !options.selector)
        return environment.fail_with(
            {program::kExitUsage,
             "subscribe to what? Write BOARD[/SERVICE]..., or choose boards by -l SELECTOR"});
    const auto targets =
        parse_targets(options.targets.empty() ? std::vector<std::string>{"*"} : options.targets);
    if (!targets) return environment.fail_with(targets.error());
    const auto labels = parse_selector(options.selector);
    if (!labels) return environment.fail_with(labels.error());
    if (options.raw && !options.field.empty())
        return environment.fail_with({program::kExitUsage, "--field takes decoded values; leave --raw away"});
    BusSession session(environment);
    session.tell_refused_subscriptions();
    BoardSource source(environment, session);
    Subscriber subscriber(options, *targets, *labels, environment, session);
    subscriber.subscribe();
    const auto deadline = options.limit ? Clock::now() + *options.limit : Time::max();
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    note_unknown(*targets, *labels, environment, source);
    while (!session.stopped() && !subscriber.enough() && Clock::now() < deadline) {
        const auto ended = [&] {
            subscriber.print_due();
            return subscriber.enough();
        };
        session.run_until(ended, std::min(deadline, Clock::now() + 1h));
    }
    const std::size_t least = std::max<std::size_t>(1, options.count);
    const bool too_few = options.limit && !session.stopped() && subscriber.count() < least;
    return too_few ? program::kExitNoAnswer : program::kExitOk;
}

namespace {

Run declare_subscribe(Declaration& verb) {
    auto options = std::make_shared<SubscribeOptions>();
    verb.arguments("BOARD[/SERVICE]", options->targets, "Whose reports; with * and ? as in a shell",
                   Declaration::Needed::kNo);
    declare_selector(verb, options->selector);
    verb.flag("--raw", options->raw, "The board's own ASIP lines instead of decoded values");
    verb.option("-n,--count", "COUNT", options->count, "End after so many; 0: no limit");
    verb.option("-W,--for", options->limit,
                "End after this time; status 4 when nothing (or less than -n) came");
    verb.flag("-t,--time", options->time, "Begin each line with the time");
    verb.flag("--age", options->age, "Show how long after the service's last event each one came");
    verb.option("--field", "FIELD", options->field,
                "Only this part of the reports: an event, a field of it, or its number");
    verb.flag("--changes", options->changes, "Only reports that say something else than the one before");
    verb.option("--max-hz", "HZ", options->max_hz,
                "At most so many a second of each kind of report, the newest of them. Boards that report on "
                "demand are asked for so many",
                0.001, 1000);
    verb.flag("--no-demand", options->no_demand, "Only listen: ask no board to report");
    verb.output(options->output, {Output::kText}, seen_fields());
    return [options](Environment& environment) { return run_subscribe(*options, environment); };
}

}  // namespace

Verb subscribe_verb() {
    return {"subscribe", "What boards report, decoded, as it comes",
            "On a terminal a header stands above the first line.\n"
            "Examples:\n"
            "  asipctl subscribe uno1/distance\n"
            "  asipctl subscribe uno1/distance --field 0 --changes --format '{value}'\n"
            "  asipctl subscribe 'uno*' --max-hz 2\n"
            "  asipctl subscribe 'uno*' -o jsonl\n"
            "  asipctl subscribe -l room=lab\n"
            "  asipctl subscribe '*/distance' -l room=lab --field 0\n"
            "  asipctl subscribe uno1/distance -n 1 -W 5 --format '{data.distance.0} cm'\n"
            "  asipctl subscribe uno1 --raw",
            declare_subscribe};
}

}  // namespace asip::cli
