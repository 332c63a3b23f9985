// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/interactive_shell.hpp"

#include <algorithm>
#include <csignal>
#include <ostream>

#include "asip/bus/registry/board_match.hpp"
#include "asip/program/options.hpp"
#include "asip/text/nearest.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/events/context_event.hpp"
#include "cli/events/decoded_event.hpp"
#include "cli/name_sources.hpp"
#include "cli/shell/line_editor.hpp"
#include "cli/shell/line_history.hpp"
#include "cli/shell/run_self.hpp"
#include "cli/shell/shell_values.hpp"
#include "cli/shell/shell_words.hpp"
#include "cli/text/state_text.hpp"

namespace asip::cli {

using namespace std::chrono_literals;

namespace {

/// The status line is drawn at most so often.
constexpr Duration kStatusPause = 200ms;
constexpr double kShownHz = 5;

}  // namespace

struct InteractiveShell::State {
    State(Environment& its_environment, std::string its_board, bool show_values)
        : environment(its_environment),
          board(std::move(its_board)),
          session(environment),
          source(environment, session),
          history(LineHistory::file_of_user(program::environment_variable)),
          editor({[this] { return prompt(); }, [this](std::size_t columns) { return status(columns); },
                  [this](const std::string& typed) {
                      return complete_shell(*environment.command_line, typed, board, names());
                  },
                  [this](const std::function<bool()>& ready) { return wait(ready); }}) {
        values.show(show_values);
    }

    int run() {
        if (const auto connected = session.connect(); !connected)
            return environment.fail_with(connected.error());
        const auto found = source.board(board);
        if (!found) return environment.fail_with(found.error());
        // From here on Ctrl-C is a key, or a signal to what runs.
        for (const int number : {SIGINT, SIGQUIT})
            std::signal(number, SIG_IGN);
        take_services(*found);
        follow();
        for (const auto& line : history.lines())
            editor.remember(line);
        editor.show_above("Commands for " + board + "; help tells which. Ctrl-D or exit ends.");
        while (!ended) {
            const auto line = editor.read();
            if (!line || session.stopped()) break;
            take_line(*line);
        }
        session.on_connection_change({});
        return program::kExitOk;
    }

    void follow() {
        session.on_board([this](const std::string&, const mqtt::Message*) { look_at_board(); });
        session.caller().watch(board);
        const auto report = [this](const mqtt::Message& message) { take_report(message); };
        for (const auto& filter :
             {environment.topics.service_out(board, "+"), environment.topics.service_error(board, "+")})
            subscriptions.push_back(session.subscribe(filter, report));
        demand_what_is_shown();
        session.on_connection_change([this](bool connected, const std::string& why) {
            online = connected;
            say(connected ? "connected again" : not_known_text(why));
        });
    }

    /// The line is drawn five times a second.
    void demand_what_is_shown() {
        wants.clear();
        if (!values.shown()) return;
        for (const auto& service : selected.empty() ? std::vector<std::string>{"*"} : selected)
            wants.push_back(session.want(board, service, kShownHz));
    }

    void take_services(const KnownBoard& known) {
        state = known.item.state;
        service_names = known.service_names();
        values.services(service_names);
    }

    void look_at_board() {
        const auto item = session.boards().board(board, catalogue::instant_now());
        if (!item) return;
        KnownBoard known{*item, std::nullopt};
        if (const auto* described = session.boards().description(board)) known.description = *described;
        const auto before = state;
        if (known.description) {
            take_services(known);
        } else {
            state = item->state;
        }
        if (state != before) say(board + " is " + state_text(*item));
    }

    void take_report(const mqtt::Message& message) {
        const auto event = context_event(environment.topics, message.topic, message.payload);
        if (!event) return;
        const auto decoded = decode_event(*event, model(event->service).get(), {});
        if (!decoded) return;
        const bool error = event->kind == ContextEvent::Kind::kError;
        values.report(event->service, error ? "error" : decoded->what,
                      error ? event->service + " error " + decoded->text : decoded->text);
    }

    model::ModelPtr model(const std::string& service) const {
        const auto* described = session.boards().description(board);
        if (described == nullptr) return nullptr;
        for (const auto& one : described->services) {
            if (one.name == service) return bus::model_of(one, environment.models());
        }
        return nullptr;
    }

    NameSources names() {
        auto result = bus_names(environment, source, [this] { return online; });
        const auto others = result;
        result.services = [this, others](const std::string& of) {
            return of == board ? service_names : others.services(of);
        };
        return result;
    }

    std::string prompt() const {
        if (!online) return board + " (no broker)> ";
        return state == "online" || state.empty() ? board + "> " : board + " (" + state + ")> ";
    }

    std::string status(std::size_t columns) const { return values.line(columns); }

    bool wait(const std::function<bool()>& ready) {
        while (!session.stopped()) {
            if (session.run_until(ready, Clock::now() + kStatusPause)) return true;
            editor.show_status();
        }
        return false;
    }

    void say(const std::string& text) { editor.show_above("asipctl: " + text); }

    void take_line(const std::string& line) {
        const auto words = shell_words(line);
        if (!words) return environment.note(words.error());
        if (words->empty()) return;
        editor.remember(line);
        if (line != last_line && !history.add(line) && !std::exchange(history_failed, true))
            environment.note("lines cannot be kept in " + history.file().string());
        last_line = line;
        take_words(*words);
    }

    void take_words(const std::vector<std::string>& words) {
        const auto& first = words.front();
        if (first == "exit" || first == "quit") {
            ended = true;
        } else if (first == "values") {
            take_values({words.begin() + 1, words.end()});
        } else if (first == "shell") {
            environment.note("this is a shell already; exit ends it");
        } else {
            run_command(words);
        }
    }

    void take_values(std::vector<std::string> wanted) {
        if (wanted.size() == 1 && (wanted.front() == "on" || wanted.front() == "off")) {
            values.show(wanted.front() == "on");
            if (values.shown()) values.select({});
            selected.clear();
            return demand_what_is_shown();
        }
        for (const auto& name : wanted) {
            if (std::find(service_names.begin(), service_names.end(), name) != service_names.end()) continue;
            return environment.note(board + " has no service '" + name + "'" +
                                    text::did_you_mean(name, service_names) +
                                    "; write values on, values off or values SERVICE...");
        }
        values.show(true);
        selected = wanted;
        values.select(std::move(wanted));
        demand_what_is_shown();
    }

    void run_command(const std::vector<std::string>& words) {
        if (words == std::vector<std::string>{"help"}) environment.out << shell_help(board) << std::flush;
        SelfRun run{arguments_for(environment, expand_words(*environment.command_line, words, board)), true,
                    [this](const std::function<bool()>& ended_now) {
                        while (!session.stopped() && !session.run_until(ended_now, Clock::now() + 1h)) {
                        }
                    }};
        if (words.size() == 1 && words.front() == "help")
            run.arguments = arguments_for(environment, {"show", board});
        environment.out.flush();
        if (const auto status = run_self(run); !status) environment.note(status.error());
    }

    Environment& environment;
    std::string board;
    BusSession session;
    BoardSource source;
    LineHistory history;
    LineEditor editor;
    ShellValues values;
    std::vector<std::string> service_names, selected;
    std::vector<bus::Demander::Want> wants;
    std::string state, last_line;
    std::vector<BusSession::Subscription> subscriptions;
    bool online = true;
    bool ended = false;
    bool history_failed = false;
};

InteractiveShell::InteractiveShell(Environment& environment, std::string board, bool values)
    : state_(std::make_unique<State>(environment, std::move(board), values)) {}
InteractiveShell::~InteractiveShell() = default;

int InteractiveShell::run() {
    return state_->run();
}

std::vector<std::string> arguments_for(const Environment& environment, std::vector<std::string> words) {
    std::vector<std::string> result;
    for (const auto& [name, value] : environment.typed_options)
        result.push_back("--" + name + "=" + value);
    result.insert(result.end(), std::make_move_iterator(words.begin()), std::make_move_iterator(words.end()));
    return result;
}

std::string shell_help(const std::string& board) {
    return "SERVICE COMMAND [ARG...]   gives a service a command, as asipctl send " + board +
           "/SERVICE does\n"
           "get SERVICE, subscribe SERVICE, pin 13 high, show, logs, wait, ...\n"
           "                           any command of asipctl, for this board: help COMMAND\n"
           "values [on|off|SERVICE...] the newest reports above the line\n"
           "exit                       as Ctrl-D\n"
           "Ctrl-C ends what runs. Tab completes. A line that begins with a blank is not kept.\n\n";
}

}  // namespace asip::cli
