#include "cli/commands/subscribe.hpp"

#include <CLI/CLI.hpp>
#include <map>
#include <ostream>

#include "asip/text/duration.hpp"
#include "cli/command.hpp"
#include "cli/context_event.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

/// Options, checked.
struct Plan {
    std::vector<Target> targets;
    std::optional<LineTemplate> format;
    std::optional<std::chrono::milliseconds> limit;
};

Outcome<Plan> plan(const SubscribeOptions& options) {
    Plan result;
    for (const auto& text : options.targets) {
        auto target = parse_target(text, true);
        if (!target) return tl::unexpected(target.error());
        result.targets.push_back(std::move(*target));
    }
    if (!options.format.empty()) {
        auto format = LineTemplate::parse(options.format);
        if (!format) return failure(program::kExitUsage, format.error());
        if (const auto checked = check_event_template(*format); !checked) {
            return failure(program::kExitUsage, checked.error());
        }
        result.format = std::move(*format);
    }
    if (!options.seconds.empty()) {
        const auto limit = text::parse_duration(options.seconds);
        if (!limit) return failure(program::kExitUsage, "-W: " + limit.error());
        result.limit = *limit;
    }
    return result;
}

class Printer {
  public:
    Printer(const SubscribeOptions& options, const Plan& plan, Context& context)
        : options_(options), plan_(plan), context_(context) {}

    void take(const mqtt::Message& message) {
        if (enough()) return;
        auto event = context_event(context_.topics, message.topic, message.payload);
        if (!event || !wanted(*event)) return;
        event->retained = message.retain;
        event->time = std::chrono::system_clock::now();
        const auto now = Clock::now();
        auto& last = last_[event->topic];
        if (last) event->age = now - *last;
        last = now;
        print(*event);
        ++count_;
    }

    bool enough() const { return options_.count != 0 && count_ >= options_.count; }
    std::size_t count() const { return count_; }

  private:
    bool wanted(const ContextEvent& event) const {
        for (const auto& target : plan_.targets) {
            if (target.matches(event.board, event.service.empty() ? target.service : event.service))
                return true;
        }
        return false;
    }

    void print(const ContextEvent& event) {
        if (plan_.format) {
            context_.out << plan_.format->fill(
                [&](std::string_view name) { return event_value(event, name); });
        } else if (options_.output == Output::kJsonLines) {
            context_.out << event_json(event);
        } else {
            context_.out << event_text(event, options_.time, options_.age, context_.colour);
        }
        context_.out << std::endl;
    }

    const SubscribeOptions& options_;
    const Plan& plan_;
    Context& context_;
    std::map<std::string, std::optional<Time>> last_;
    std::size_t count_ = 0;
};

/// A name that nobody has is told at once, but a board may still come.
void note_unknown(const Plan& plan, Context& context, BoardSource& source) {
    for (const auto& target : plan.targets) {
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
    const auto checked = plan(options);
    if (!checked) return context.fail_with(checked.error());
    BusSession session(context);
    BoardSource source(context, session);
    Printer printer(options, *checked, context);
    for (const auto& filter : context_filters(context.topics, checked->targets, options.raw)) {
        session.subscribe(filter, [&printer](const mqtt::Message& message) { printer.take(message); });
    }
    session.on_connection_change([&context](bool connected, const std::string& why) {
        context.note(connected ? "connected again" : why);
    });
    const auto deadline = checked->limit ? Clock::now() + *checked->limit : Time::max();
    if (const auto connected = session.connect(); !connected) return context.fail_with(connected.error());
    note_unknown(*checked, context, source);
    while (!session.stopped() && !printer.enough() && Clock::now() < deadline) {
        session.run_until([&] { return printer.enough(); }, std::min(deadline, Clock::now() + 1h));
    }
    if (!session.subscription_refused().empty())
        context.note("the broker refused " + session.subscription_refused());
    const std::size_t least = std::max<std::size_t>(1, options.count);
    const bool too_few = checked->limit && !session.stopped() && printer.count() < least;
    return too_few ? program::kExitNoAnswer : program::kExitOk;
}

void setup_subscribe(CLI::App& app, Chosen& chosen) {
    auto* command = app.add_subcommand("subscribe", "What boards report, decoded, as it comes");
    command->fallthrough();
    auto options = std::make_shared<SubscribeOptions>();
    command->add_option("targets", options->targets, "BOARD or BOARD/SERVICE, with * and ? as in a shell")
        ->required()
        ->type_name("");
    command->add_flag("--raw", options->raw, "The board's own ASIP lines instead of decoded values");
    command->add_option("-n,--count", options->count, "End after this many")->type_name("COUNT");
    command
        ->add_option("-W,--for", options->seconds,
                     "End after this time; status 4 when nothing (or less than -n) came")
        ->type_name("DURATION");
    command
        ->add_option(
            "--format", options->format,
            "Line to print: {time} {board} {service} {where} {topic} {kind} {payload} {age} {data.PATH}")
        ->type_name("TEMPLATE");
    command->add_flag("-t,--time", options->time, "Begin each line with the time");
    command->add_flag("--age", options->age, "Show how long after the service's last event each one came");
    add_output_option(*command, options->output, {Output::kText, Output::kJsonLines});
    command->footer(
        "Examples:\n"
        "  asipctl subscribe uno1/distance\n"
        "  asipctl subscribe 'uno*' -o jsonl\n"
        "  asipctl subscribe uno1/distance -n 1 -W 5 --format '{data.distance.0} cm'\n"
        "  asipctl subscribe uno1 --raw");
    command->callback([&chosen, options] {
        chosen = [options](Context& context) { return run_subscribe(*options, context); };
    });
}

}  // namespace asip::cli
