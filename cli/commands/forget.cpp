// SPDX-License-Identifier: Apache-2.0
#include <list>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "asip/protocol/request.hpp"
#include "asip/text/nearest.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/ask/forget_request.hpp"
#include "cli/ask/lingering.hpp"
#include "cli/ask/retained.hpp"
#include "cli/ask/side_by_side.hpp"
#include "cli/declaration.hpp"
#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/output.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

struct ForgetOptions {
    std::vector<std::string> boards;  ///< names, and patterns of them
    bool leftovers = false;           ///< in place of boards
    std::vector<std::string> kinds;   ///< of leftovers
    bool dry_run = false;
    bool force = false;  ///< also boards that seem alive
    OutputOptions output{};
};

/// One `asipctl forget`.
class Forgetter : OnTheBus {
  public:
    Forgetter(const ForgetOptions& options, std::vector<Target> targets, Environment& environment)
        : OnTheBus(environment), options_(options), targets_(std::move(targets)) {}

    int run() {
        if (const auto status = connect()) return *status;
        auto retained = read_retained(environment_, session_, filters());
        if (!retained) return environment_.fail_with(retained.error());
        retained_ = std::move(*retained);
        if (const auto chosen = choose(); !chosen) return environment_.fail_with(chosen.error());
        if (!options_.force) leave_living_boards();
        // A board that could not be asked is not gone.
        if (const auto heard = session_.heard_all(); !heard) return environment_.fail_with(heard.error());
        if (!options_.force && !options_.dry_run) ask_registry();
        leave_unknown_boards();
        return options_.dry_run ? show() : clear();
    }

  private:
    struct Board {
        std::string name;
        bool named = false;  ///< not chosen by a pattern
        std::vector<std::string> topics{};
        bool forgotten = false;  ///< by a registry
        bool alive = false;
        std::vector<BusSession::Subscription> heard{};
        BusSession::Request request{};
    };

    std::vector<std::string> filters() const {
        const auto& topics = environment_.topics;
        std::vector<std::string> result;
        for (const auto& target : targets_) {
            if (target.is_pattern()) return {topics.root() + "/#"};
            result.push_back(topics.service_names(target.board) + "/#");
            result.push_back(topics.root() + "/" + target.board + "/#");
        }
        return result;
    }

    void fail(const std::string& text) { status_ = environment_.fail_with({program::kExitFailure, text}); }

    /// What is retained and what a registry knows.
    Outcome<std::set<std::string>> names_like(const Target& target) {
        std::set<std::string> names;
        for (const auto& name : announced_boards(environment_.topics, retained_))
            if (target.matches(name, "")) names.insert(name);
        if (source_.find_registry().empty()) return names;
        bus::Query query;
        query.board = target.board;
        auto boards = source_.boards(std::move(query));
        if (!boards) return tl::unexpected(boards.error());
        for (const auto& board : *boards)
            names.insert(board.board);
        return names;
    }

    void add(const std::string& name, bool named) {
        const auto found = std::find_if(boards_.begin(), boards_.end(),
                                        [&name](const Board& board) { return board.name == name; });
        if (found == boards_.end())
            boards_.push_back({name, named, topics_of_board(environment_.topics, retained_, name)});
        else
            found->named = found->named || named;
    }

    Outcome<void> choose() {
        for (const auto& target : targets_) {
            if (!target.is_pattern()) {
                add(target.board, true);
                continue;
            }
            const auto names = names_like(target);
            if (!names) return tl::unexpected(names.error());
            if (names->empty()) fail("no board is like " + target.board + "; see asipctl list");
            for (const auto& name : *names)
                add(name, false);
        }
        return {};
    }

    /// Whether an agent (or the board itself) still answers, whatever is retained.
    Time ask(Board& board) {
        const auto& topics = environment_.topics;
        const auto hear = [&board](const mqtt::Message& message) {
            board.alive = board.alive || !message.retain;
        };
        board.heard.push_back(session_.subscribe(topics.description(board.name), hear, {.retained = false}));
        board.heard.push_back(session_.subscribe(topics.board_out(board.name), hear, {.retained = false}));
        board.request = session_.ask(topics.board_in(board.name), std::string(protocol::kAskInfo), hear);
        session_.publish(topics.probe(), board.name);
        return Clock::now() + kProbeWindow;
    }

    /// Those that were named are asked; of a pattern only boards count that are known to be gone.
    void leave_living_boards() {
        std::list<Board*> seeming;
        std::string left;
        for (auto& board : boards_) {
            if (!seems_alive(environment_.topics, retained_, board.name)) continue;
            if (board.named) {
                seeming.push_back(&board);
                continue;
            }
            left += (left.empty() ? "" : ", ") + board.name;
            board.alive = true;
        }
        if (!left.empty()) environment_.note("not gone, left alone: " + left);
        ask_side_by_side(
            session_, std::move(seeming), kAskedAtOnce, [this](Board& board) { return ask(board); },
            [](const Board& board) { return board.alive; });
        for (const auto& board : boards_)
            if (board.named && board.alive)
                fail(board.name +
                     " is alive; stop its agent first (--force clears it all the same, and its agent will "
                     "announce it anew)");
        std::erase_if(boards_, [](const Board& board) { return board.alive; });
    }

    void ask_registry() {
        std::vector<std::string> names;
        for (const auto& board : boards_)
            names.push_back(board.name);
        const auto asked = ask_to_forget(environment_, session_, source_, names);
        if (asked.status != program::kExitOk) status_ = asked.status;
        std::erase_if(boards_, [&asked](const Board& board) { return asked.refused.contains(board.name); });
        for (auto& board : boards_)
            board.forgotten = asked.forgotten.contains(board.name);
    }

    void leave_unknown_boards() {
        for (const auto& board : boards_)
            if (board.named && board.topics.empty() && !board.forgotten)
                fail("unknown board \"" + board.name + "\"" +
                     text::did_you_mean(board.name, source_.names()) +
                     ": nothing is retained of it; see asipctl list");
        std::erase_if(boards_, [](const Board& board) { return board.topics.empty() && !board.forgotten; });
    }

    std::vector<std::string> topics() const {
        std::vector<std::string> all;
        for (const auto& board : boards_)
            all.insert(all.end(), board.topics.begin(), board.topics.end());
        return all;
    }

    void print_topics() {
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        for (const auto& board : boards_) {
            for (const auto& topic : board.topics)
                if (options_.output.for_people())
                    environment_.say(topic);
                else
                    records.print({{"topic", topic}, {"board", board.name}});
        }
        records.finish();
        environment_.out << std::flush;
    }

    std::string boards_in_words() const {
        return boards_.size() == 1 ? boards_.front().name : counted(boards_.size(), "board");
    }

    int show() {
        print_topics();
        if (!boards_.empty())
            environment_.note("would forget " + boards_in_words() + ": " +
                              counted(topics().size(), "retained topic") + " to clear");
        return nothing_done();
    }

    int clear() {
        const auto all = topics();
        if (const auto cleared = clear_retained(environment_, session_, all); !cleared)
            return environment_.fail_with(cleared.error());
        print_topics();
        if (!boards_.empty())
            environment_.note("forgot " + boards_in_words() + ": " + counted(all.size(), "retained topic") +
                              " cleared");
        return nothing_done();
    }

    int nothing_done() const {
        return boards_.empty() && status_ == program::kExitOk ? program::kExitFailure : status_;
    }

    const ForgetOptions& options_;
    const std::vector<Target> targets_;
    std::vector<Retained> retained_;
    std::list<Board> boards_;
    int status_ = program::kExitOk;
};

/// `asipctl forget`: boards that are gone leave every registry, and their retained topics are emptied.
/// kExitFailure when one is unknown or alive, or when a pattern means none.
int run_forget(const ForgetOptions& options, Environment& environment) {
    if (options.leftovers && !options.boards.empty())
        return environment.fail_with({program::kExitUsage, "name boards, or write --leftovers"});
    if (options.leftovers)
        return clear_lingering({options.dry_run, options.kinds, options.output}, environment);
    if (options.boards.empty())
        return environment.fail_with(
            {program::kExitUsage, "which boards? --leftovers clears all that is no longer needed"});
    if (!options.kinds.empty())
        return environment.fail_with({program::kExitUsage, "--only goes with --leftovers"});
    std::vector<Target> targets;
    for (const auto& board : options.boards) {
        auto target = parse_target(board, true);
        if (!target) return environment.fail_with(target.error());
        if (!target->service.empty())
            return environment.fail_with(
                {program::kExitUsage, "'" + board + "': forget takes boards, not services"});
        targets.push_back(std::move(*target));
    }
    return Forgetter(options, std::move(targets), environment).run();
}

Run declare_forget(Declaration& verb) {
    auto options = std::make_shared<ForgetOptions>();
    verb.arguments("PATTERN", options->boards,
                   "Names of boards; with * and ? as in a shell: all such boards that are gone",
                   Declaration::Needed::kNo);
    verb.flag("--leftovers", options->leftovers,
              "Everything retained that is no longer needed, of any board");
    verb.option(
        "--only", "boards|commands|orphans|names|documents|registries", options->kinds,
        "Of --leftovers only these: boards that are gone, retained commands, values of unknown boards, names "
        "that are not valid, descriptions that cannot be read, registries that are gone");
    verb.flag("--dry-run", options->dry_run, "Only show what would be cleared");
    verb.flag("--force", options->force, "Also boards that seem alive");
    verb.output(options->output, {Output::kTable, Output::kName}, {"topic", "board", "kind", "why"});
    return [options](Environment& environment) { return run_forget(*options, environment); };
}

}  // namespace

Verb forget_verb() {
    return {"forget", "Clear everything that is kept of boards that are gone",
            "Prints the topics that are cleared. A board that answers is refused. By a pattern, only boards "
            "are forgotten\nthat are offline or lost, or whose lease ran out.\n"
            "Exit status: 0 all forgotten, 1 one was refused or is unknown, or there was none.\n"
            "Examples:\n"
            "  asipctl forget uno7\n"
            "  asipctl forget uno7 uno8\n"
            "  asipctl forget 'old-*' --dry-run\n"
            "  asipctl forget 'old-*'\n"
            "  asipctl forget --leftovers --only commands",
            declare_forget};
}

}  // namespace asip::cli
