// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>

#include "asip/catalogue/bus_view.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/json.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"
#include "cli/events/context_event.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"
#include "cli/text/state_text.hpp"

namespace asip::cli {
namespace {

struct WaitOptions {
    std::string target;           ///< BOARD or BOARD/SERVICE
    std::string what = "online";  ///< a state of the board, or the name of an event
    OutputOptions output{};
};

/// Watches one board until what is waited for has come.
class Waiter {
  public:
    Waiter(const WaitOptions& options, Environment& environment, Target target)
        : options_(options),
          environment_(environment),
          targets_{std::move(target)},
          for_state_(model::board_state_from_text(options.what).has_value()),
          session_(environment) {}

    int run() {
        session_.caller().watch(board());
        session_.caller().watch_names(board());
        retained_ = session_.mark_retained();
        if (!for_state_) watch_events();
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        const auto deadline = Clock::now() + environment_.timeout;
        session_.publish(environment_.topics.probe(), board());
        session_.run_until([this] { return came(); }, deadline);
        // However short it is: what is retained was looked at once.
        session_.run_until([this] { return came() || retained_->passed(); },
                           std::max(deadline, Clock::now() + kMarkPatience));
        if (came()) return print();
        if (session_.stopped()) return environment_.fail_with(interrupted().value());
        return environment_.fail_with(
            session_.unanswered(targets_.front().text() + ": no " + options_.what + " within " +
                                std::to_string(environment_.timeout.count()) + " ms; " + present()));
    }

  private:
    const std::string& board() const { return targets_.front().board; }

    void watch_events() {
        want_ = session_.want(board(), targets_.front().service);
        for (const auto& filter : context_filters(environment_.topics, targets_, false)) {
            subscriptions_.push_back(session_.subscribe(filter, [this](const mqtt::Message& message) {
                if (!message.retain && !event_) take_event(message);
            }));
        }
    }

    void take_event(const mqtt::Message& message) {
        auto event = context_event(environment_.topics, message.topic, message.payload);
        if (!event || event->kind != ContextEvent::Kind::kValue) return;
        if (!is_wanted(*event, targets_, session_.boards().description(board()))) return;
        const auto document = model::parse_json(event->payload);
        if (!document || !document->is_object() || !document->contains(options_.what)) return;
        event->time = std::chrono::system_clock::now();
        event_ = std::move(event);
    }

    /// What it is now, for people.
    std::string present() const {
        const auto known = session_.boards().board(board(), catalogue::instant_now());
        if (!known) return "the board is not announced";
        if (!reported(*known)) return "its state is not known: only an old description is retained";
        return "the board is " + state_text(*known);
    }

    /// A retained description may arrive before the state that contradicts it; an old one
    /// without an agent has none. Boards without states are those that are heard.
    bool reported(const bus::BoardItem& known) const {
        const bool all_retained = retained_ && retained_->passed();
        return all_retained ? !known.reported.empty() || known.age >= 0 : known.age >= 0 && !known.names_only;
    }

    bool came() const {
        if (!for_state_) return event_.has_value();
        const auto known = session_.boards().board(board(), catalogue::instant_now());
        if (!known || known->state != options_.what || !reported(*known)) return false;
        // An online board can be used once it has a description.
        return options_.what != "online" || known->names_only ||
               session_.boards().description(board()) != nullptr;
    }

    int print() const {
        if (!options_.output.for_people()) {
            auto record = event_ ? event_json(*event_)
                                 : nlohmann::json{{"board", board()},
                                                  {"state", options_.what},
                                                  {"time", text::iso_time(text::wall_now())}};
            RecordPrinter(options_.output, RecordPrinter::Count::kOne, environment_.out).print(record);
        } else if (event_) {
            environment_.out << event_text(*event_, event_->payload, false, false, environment_.colour)
                             << std::endl;
        }
        return program::kExitOk;
    }

    const WaitOptions& options_;
    Environment& environment_;
    std::vector<Target> targets_;
    bool for_state_;
    BusSession session_;
    std::optional<BusSession::Mark> retained_;
    std::optional<ContextEvent> event_;
    std::vector<BusSession::Subscription> subscriptions_;
    bus::Demander::Want want_{};
};

/// `asipctl wait`: returns kExitOk once the board is in the state (at once when it is already), or once the
/// event was reported; kExitNoAnswer when it did not come within the context's timeout.
int run_wait(const WaitOptions& options, Environment& environment) {
    auto target = parse_target(options.target);
    if (!target) return environment.fail_with(target.error());
    return Waiter(options, environment, std::move(*target)).run();
}

Run declare_wait(Declaration& verb) {
    auto options = std::make_shared<WaitOptions>();
    verb.argument("BOARD[/SERVICE]", options->target, "Which");
    verb.option("--for", "online|offline|lost|sleeping|updating|...", options->what,
                "A state of the board, or the name of an event");
    verb.output(options->output, {Output::kText}, {"board", "state", "time", "service", "event", "age"});
    return [options](Environment& environment) { return run_wait(*options, environment); };
}

}  // namespace

Verb wait_verb() {
    return {"wait", "Wait until a board is in a state, or reports an event",
            "Ends at once when the board is in that state. --timeout says how long to wait, 0: only look; "
            "status 4\n"
            "when it did not come. A state prints nothing, an event is printed.\n"
            "Examples:\n"
            "  asipctl wait uno1 --timeout 1m && asipctl send uno1/servo write 0 90\n"
            "  asipctl wait uno1 --for lost --timeout 12h\n"
            "  asipctl wait uno1/io --for digital --timeout 30s",
            declare_wait};
}

}  // namespace asip::cli
