#include "cli/commands/subscribe.hpp"

#include <map>
#include <ostream>

#include "asip/bus/mirror.hpp"
#include "cli/context_event.hpp"
#include "cli/declaration.hpp"

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

class EventPrinter {
  public:
    EventPrinter(const SubscribeOptions& options, Context& context)
        : options_(options),
          context_(context),
          records_(options.output, RecordPrinter::Count::kStream, context.out) {
        // Checked when the command line was read.
        if (!options.output.format.empty()) template_ = *LineTemplate::parse(options.output.format);
    }

    void print(const ContextEvent& event) {
        if (template_) {
            context_.out << template_->fill([&](std::string_view name) { return event_value(event, name); })
                         << std::endl;
        } else if (!options_.output.for_people()) {
            records_.print(event_json(event));
        } else {
            context_.out << event_text(event, options_.time, options_.age, context_.colour) << std::endl;
        }
    }

  private:
    const SubscribeOptions& options_;
    Context& context_;
    RecordPrinter records_;
    std::optional<LineTemplate> template_;
};

/// Takes what comes, keeps what is wanted and prints it.
class Subscriber {
  public:
    Subscriber(const SubscribeOptions& options, std::vector<Target> targets, Context& context)
        : options_(options),
          context_(context),
          targets_(std::move(targets)),
          catalogue_(context.topics),
          printer_(options, context) {}

    void subscribe(BusSession& session) {
        // First: a line or a letter is attributed to a service by the board's description.
        for (const auto& filter : description_filters(context_.topics, targets_, options_.raw)) {
            subscriptions_.push_back(session.subscribe(filter, [this](const mqtt::Message& message) {
                catalogue_.apply(message.topic, message.payload, message.retain, Clock::now());
            }));
        }
        for (const auto& filter : context_filters(context_.topics, targets_, options_.raw)) {
            subscriptions_.push_back(
                session.subscribe(filter, [this](const mqtt::Message& message) { take(message); }));
        }
    }

    bool enough() const { return options_.count != 0 && count_ >= options_.count; }
    std::size_t count() const { return count_; }

  private:
    void take(const mqtt::Message& message) {
        if (enough()) return;
        auto event = context_event(context_.topics, message.topic, message.payload);
        if (!event || !is_wanted(*event, targets_, catalogue_.description(event->board))) return;
        event->retained = message.retain;
        event->time = std::chrono::system_clock::now();
        const auto now = Clock::now();
        auto& last = last_[event->topic];
        if (last) event->age = now - *last;
        last = now;
        printer_.print(*event);
        ++count_;
    }

    const SubscribeOptions& options_;
    Context& context_;
    std::vector<Target> targets_;
    bus::Mirror catalogue_;
    EventPrinter printer_;
    std::map<std::string, std::optional<Time>> last_;
    std::size_t count_ = 0;
    std::vector<BusSession::Subscription> subscriptions_;
};

/// A name that no board has is reported at once, but one may still come.
void note_unknown(const std::vector<Target>& targets, Context& context, BoardSource& source) {
    for (const auto& target : targets) {
        if (target.is_pattern()) continue;
        const auto board = source.board(target.board);
        if (!board) {
            context.note(board.error().text + "; waiting for it");
            continue;
        }
        if (!target.service.empty() && board->description) {
            if (const auto service = find_service(*board, target.service); !service)
                context.note(service.error().text);
        }
        if (board->item.state != "online")
            context.note(target.board + " is " + board->item.state + "; waiting for it");
    }
}

}  // namespace

int run_subscribe(const SubscribeOptions& options, Context& context) {
    const auto targets = parse_targets(options.targets);
    if (!targets) return context.fail_with(targets.error());
    BusSession session(context);
    BoardSource source(context, session);
    Subscriber subscriber(options, *targets, context);
    subscriber.subscribe(session);
    session.on_connection_change([&context](bool connected, const std::string& why) {
        context.note(connected ? "connected again" : why);
    });
    const auto deadline = options.limit ? Clock::now() + *options.limit : Time::max();
    if (const auto connected = session.connect(); !connected) return context.fail_with(connected.error());
    note_unknown(*targets, context, source);
    while (!session.stopped() && !subscriber.enough() && Clock::now() < deadline) {
        session.run_until([&] { return subscriber.enough(); }, std::min(deadline, Clock::now() + 1h));
    }
    if (!session.subscription_refused().empty())
        context.note("the broker refused " + session.subscription_refused());
    const std::size_t least = std::max<std::size_t>(1, options.count);
    const bool too_few = options.limit && !session.stopped() && subscriber.count() < least;
    return too_few ? program::kExitNoAnswer : program::kExitOk;
}

namespace {

Run declare_subscribe(Declaration& verb) {
    auto options = std::make_shared<SubscribeOptions>();
    verb.arguments("BOARD[/SERVICE]", options->targets, "Whose reports; with * and ? as in a shell");
    verb.flag("--raw", options->raw, "The board's own ASIP lines instead of decoded values");
    verb.option("-n,--count", "COUNT", options->count, "End after so many; 0: no limit");
    verb.option("-W,--for", options->limit,
                "End after this time; status 4 when nothing (or less than -n) came");
    verb.flag("-t,--time", options->time, "Begin each line with the time");
    verb.flag("--age", options->age, "Show how long after the service's last event each one came");
    verb.output(options->output, {Output::kText}, event_fields());
    return [options](Context& context) { return run_subscribe(*options, context); };
}

}  // namespace

Verb subscribe_verb() {
    return {"subscribe", "What boards report, decoded, as it comes",
            "Examples:\n"
            "  asipctl subscribe uno1/distance\n"
            "  asipctl subscribe 'uno*' -o jsonl\n"
            "  asipctl subscribe uno1/distance -n 1 -W 5 --format '{data.distance.0} cm'\n"
            "  asipctl subscribe uno1 --raw",
            declare_subscribe};
}

}  // namespace asip::cli
