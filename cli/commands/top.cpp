#include "cli/commands/top.hpp"

#include <CLI/CLI.hpp>
#include <ostream>

#include "asip/bus/pattern.hpp"
#include "asip/bus/reply.hpp"
#include "asip/protocol/request.hpp"
#include "asip/text/duration.hpp"
#include "cli/board_source.hpp"
#include "cli/command.hpp"
#include "cli/context_event.hpp"
#include "cli/top_model.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxPings = 50;

class Top {
  public:
    Top(const TopOptions& options, Context& context, Duration interval)
        : options_(options),
          context_(context),
          interval_(interval),
          session_(context),
          catalogue_(context.topics),
          model_(5s) {}

    int run() {
        const auto announce = [this](const mqtt::Message& message) { take_announcement(message); };
        session_.subscribe(context_.topics.board_names() + "/+/+", announce);
        const auto report = [this](const mqtt::Message& message) { take_report(message); };
        session_.subscribe(context_.topics.service_out("+", "+"), report,
                           {.qos = 0, .no_local = false, .retained = false});
        session_.subscribe(context_.topics.service_error("+", "+"), report,
                           {.qos = 0, .no_local = false, .retained = false});
        session_.on_connection_change(
            [this](bool connected, const std::string& why) { lost_ = connected ? "" : why; });
        if (const auto connected = session_.connect(); !connected)
            return context_.fail_with(connected.error());
        session_.publish(context_.topics.probe(), "");
        for (std::size_t round = 0; !session_.stopped() && (options_.count == 0 || round < options_.count);
             ++round) {
            if (options_.ping && lost_.empty()) ping_all();
            session_.run_for(interval_);
            draw();
        }
        return program::kExitOk;
    }

  private:
    bool wanted(const std::string& board) const { return bus::matches_pattern(options_.pattern, board); }

    void take_announcement(const mqtt::Message& message) {
        const auto now = Clock::now();
        const auto name = catalogue_.apply(message.topic, message.payload, message.retain, now);
        if (name.empty() || !wanted(name)) return;
        const auto board = catalogue_.board(name, now);
        if (!board) return;
        model_.state(name, board->state);
        for (const auto& service : board->services)
            model_.announced(name, service.name, service.period);
    }

    void take_report(const mqtt::Message& message) {
        const auto event = context_event(context_.topics, message.topic, message.payload);
        if (!event || !wanted(event->board) || message.retain) return;
        if (event->kind == ContextEvent::Kind::kError) {
            model_.error(event->board, event->service, Clock::now());
        } else {
            model_.value(event->board, event->service, event->payload, Clock::now());
        }
    }

    void ping_all() {
        std::size_t count = 0;
        for (const auto& [name, request] : pings_) {
            session_.forget_request(request);
            model_.round_trip(name, std::nullopt);
        }
        pings_.clear();
        for (const auto& board : catalogue_.boards(Clock::now())) {
            if (!wanted(board.board) || board.state != "online" || board.by_name || ++count > kMaxPings)
                continue;
            const auto begin = Clock::now();
            const auto name = board.board;
            pings_[name] = session_.ask(context_.topics.board_in(name), std::string(protocol::kAskInfo),
                                        [this, name, begin](const mqtt::Message& message) {
                                            const auto reply = bus::parse_reply(message.payload);
                                            pings_.erase(name);
                                            if (!reply || !reply->succeeded())
                                                return model_.round_trip(name, std::nullopt);
                                            model_.round_trip(name, Clock::now() - begin);
                                        });
        }
    }

    void draw() {
        // Home and clear: the table is drawn over itself.
        if (context_.terminal()) context_.out << "\033[H\033[J";
        if (!lost_.empty()) context_.out << lost_ << '\n';
        context_.out << model_.table(Clock::now()).render(context_.width, context_.colour);
        if (!context_.terminal()) context_.out << '\n';
        context_.out << std::flush;
    }

    const TopOptions& options_;
    Context& context_;
    Duration interval_;
    BusSession session_;
    BusCatalogue catalogue_;
    TopModel model_;
    std::map<std::string, std::size_t> pings_;
    std::string lost_;
};

}  // namespace

int run_top(const TopOptions& options, Context& context) {
    const auto interval = text::parse_duration(options.interval);
    if (!interval || *interval < 50ms) {
        return context.fail_with(
            {program::kExitUsage, "-i: " + (interval ? "at least 50ms" : interval.error())});
    }
    return Top(options, context, *interval).run();
}

void setup_top(CLI::App& app, Chosen& chosen) {
    auto* command = app.add_subcommand("top", "Live: rate, age, errors and round trip of each service");
    command->fallthrough();
    auto options = std::make_shared<TopOptions>();
    auto no_ping = std::make_shared<bool>(false);
    command->add_option("boards", options->pattern, "Only boards of this name; * and ? as in a shell")
        ->type_name("");
    command->add_option("-i,--interval", options->interval, "Between refreshes")
        ->capture_default_str()
        ->type_name("DURATION");
    command->add_option("-n,--count", options->count, "End after so many refreshes")->type_name("COUNT");
    command->add_flag("--no-ping", *no_ping, "Do not measure round trips");
    command->footer("Examples:\n  asipctl top\n  asipctl top 'uno*' -i 200ms\n  asipctl top -n 1");
    command->callback([&chosen, options, no_ping] {
        chosen = [options, no_ping](Context& context) {
            options->ping = !*no_ping;
            return run_top(*options, context);
        };
    });
}

}  // namespace asip::cli
