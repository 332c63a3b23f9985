// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "asip/catalogue/bus_view.hpp"
#include "asip/model/board_state.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"
#include "cli/text/state_text.hpp"

namespace asip::cli {
namespace {

struct WaitOptions {
    std::string board;
    std::string state = "online";
    OutputOptions output{};
};

/// Watches one board until it is in the state.
class Waiter {
  public:
    Waiter(const WaitOptions& options, Environment& environment)
        : options_(options), environment_(environment), session_(environment) {}

    int run() {
        session_.caller().watch(board());
        session_.caller().watch_names(board());
        retained_ = session_.mark_retained();
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
        return environment_.fail_with(session_.unanswered(board() + ": no " + options_.state + " within " +
                                                          std::to_string(environment_.timeout.count()) +
                                                          " ms; " + present()));
    }

  private:
    const std::string& board() const { return options_.board; }

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
        const auto known = session_.boards().board(board(), catalogue::instant_now());
        if (!known || known->state != options_.state || !reported(*known)) return false;
        // An online board can be used once it has a description.
        return options_.state != "online" || known->names_only ||
               session_.boards().description(board()) != nullptr;
    }

    int print() const {
        if (!options_.output.for_people())
            RecordPrinter(options_.output, RecordPrinter::Count::kOne, environment_.out)
                .print({{"board", board()},
                        {"state", options_.state},
                        {"time", text::iso_time(text::wall_now())}});
        return program::kExitOk;
    }

    const WaitOptions& options_;
    Environment& environment_;
    BusSession session_;
    std::optional<BusSession::Mark> retained_;
};

/// `asipctl wait`: returns kExitOk once the board is in the state (at once when it is already); kExitNoAnswer
/// when it did not come within the context's timeout.
int run_wait(const WaitOptions& options, Environment& environment) {
    const auto target = parse_target(options.board);
    if (!target) return environment.fail_with(target.error());
    if (!target->service.empty())
        return environment.fail_with({program::kExitUsage, "wait takes a board, not a service"});
    return Waiter(options, environment).run();
}

Run declare_wait(Declaration& verb) {
    auto options = std::make_shared<WaitOptions>();
    verb.argument("BOARD", options->board, "Which");
    verb.option("--for", "online|offline|lost|sleeping|updating", options->state, "Its state");
    verb.output(options->output, {Output::kText}, {"board", "state", "time"});
    return [options](Environment& environment) { return run_wait(*options, environment); };
}

}  // namespace

Verb wait_verb() {
    return {"wait", "Wait until a board is in a state",
            "Ends at once when the board is in that state. --timeout says how long to wait, 0: only look; "
            "status 4\n"
            "when it did not come.\n"
            "Examples:\n"
            "  asipctl wait uno1 --timeout 1m && asipctl send uno1/servo write 0 90\n"
            "  asipctl wait uno1 --for lost --timeout 12h",
            declare_wait};
}

}  // namespace asip::cli
