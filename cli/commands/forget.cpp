#include "cli/commands/forget.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>

#include "asip/model/json.hpp"
#include "asip/protocol/request.hpp"
#include "cli/board_source.hpp"
#include "cli/command.hpp"
#include "cli/retained.hpp"
#include "cli/target.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

/// Asks the registry to forget; true when it did or knew nothing of the board, and where there is none.
Outcome<void> tell_registry(Context& context, BusSession& session, BoardSource& source,
                            const std::string& board) {
    const auto registry = source.registry().empty() ? source.find_registry() : source.registry();
    if (registry.empty()) return {};
    std::optional<Expected<bus::Answer>> answer;
    bus::RegistryRequest request;
    request.what = bus::Forget{board, false};
    session.ask(context.topics.registry_query(registry), bus::encode(request),
                [&answer](const mqtt::Message& message) { answer = bus::parse_answer(message.payload); });
    session.run_until([&answer] { return answer.has_value(); }, Clock::now() + context.timeout);
    if (!answer || !*answer)
        return failure(program::kExitNoAnswer, "registry " + registry + " did not answer");
    if (!(*answer)->refused.empty() && (*answer)->refused != "unknown-board") {
        return failure(program::kExitFailure, "registry " + registry + ": " + (*answer)->error);
    }
    return {};
}

/// Whether an agent (or the board itself) still speaks for it, whatever is retained.
bool answers(Context& context, BusSession& session, const std::string& board) {
    bool heard = false;
    const auto hear = [&heard](const mqtt::Message& message) { heard = heard || !message.retain; };
    session.subscribe(context.topics.description(board), hear,
                      {.qos = 0, .no_local = false, .retained = false});
    session.subscribe(context.topics.board_out(board), hear,
                      {.qos = 0, .no_local = false, .retained = false});
    const auto id = session.ask(context.topics.board_in(board), std::string(protocol::kAskInfo), hear);
    session.publish(context.topics.probe(), board);
    session.run_until([&heard] { return heard; }, Clock::now() + kProbeWindow);
    session.forget_request(id);
    return heard;
}

void print_topics(const std::vector<std::string>& topics, Output output, Context& context) {
    for (const auto& topic : topics) {
        context.out << (output == Output::kText ? topic : model::dump_json(nlohmann::json{{"topic", topic}}))
                    << '\n';
    }
    context.out << std::flush;
}

std::string kind_name(Lingering::Kind kind) {
    switch (kind) {
        case Lingering::Kind::kGoneBoard:
            return "boards";
        case Lingering::Kind::kCommand:
            return "commands";
        case Lingering::Kind::kOrphan:
            return "orphans";
        case Lingering::Kind::kIllegal:
            return "names";
        case Lingering::Kind::kGoneRegistry:
            break;
    }
    return "registries";
}

void print_lingering(const std::vector<Lingering>& all, Output output, Context& context) {
    Table table({{"TOPIC", false, 20}, {"KIND"}, {"WHY", false, 10}});
    for (const auto& one : all) {
        if (output == Output::kTable) {
            table.add({one.topic, kind_name(one.kind), one.why});
        } else if (output == Output::kName) {
            context.out << one.topic << '\n';
        } else {
            context.out << model::dump_json(nlohmann::json{{"topic", one.topic},
                                                           {"kind", kind_name(one.kind)},
                                                           {"board", one.board},
                                                           {"why", one.why}})
                        << '\n';
        }
    }
    if (!table.empty()) context.out << table.render(context.width, context.colour);
    context.out << std::flush;
}

std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Boards that a registry will not forget (they just came back, for one) are taken out of `lingering`.
int tell_registry_of_all(Context& context, BusSession& session, BoardSource& source,
                         std::vector<Lingering>& lingering) {
    std::set<std::string> boards;
    for (const auto& one : lingering) {
        if (one.kind == Lingering::Kind::kGoneBoard) boards.insert(one.board);
    }
    int status = program::kExitOk;
    for (const auto& board : boards) {
        if (const auto told = tell_registry(context, session, source, board); !told) {
            status = context.fail_with(told.error());
            std::erase_if(lingering, [&board](const Lingering& one) { return one.board == board; });
        }
        if (source.registry().empty()) break;
    }
    return status;
}

}  // namespace

int run_forget(const ForgetOptions& options, Context& context) {
    const auto target = parse_target(options.board);
    if (!target) return context.fail_with(target.error());
    if (!target->service.empty())
        return context.fail_with({program::kExitUsage, "forget takes a board, not a service"});
    BusSession session(context);
    BoardSource source(context, session);
    if (const auto connected = session.connect(); !connected) return context.fail_with(connected.error());
    const auto& board = target->board;
    const auto all = read_retained(
        context, session,
        {context.topics.service_names(board) + "/#", context.topics.root() + "/" + board + "/#"});
    const auto topics = topics_of_board(context.topics, all, board);
    if (!options.force && seems_alive(context.topics, all, board) && answers(context, session, board)) {
        return context.fail_with(
            {program::kExitFailure, board + " is alive; stop its agent first (--force clears it all the "
                                            "same, and its agent will announce it anew)"});
    }
    if (options.dry_run) {
        print_topics(topics, options.output, context);
        context.note("would clear " + counted(topics.size(), "retained topic"));
        return program::kExitOk;
    }
    if (!options.force) {
        if (const auto told = tell_registry(context, session, source, board); !told)
            return context.fail_with(told.error());
    }
    if (topics.empty() && source.registry().empty()) {
        return context.fail_with(
            {program::kExitFailure, "nothing is retained of a board '" + board + "'; see asipctl list"});
    }
    if (const auto cleared = clear_retained(context, session, topics); !cleared)
        return context.fail_with(cleared.error());
    print_topics(topics, options.output, context);
    context.note("forgot " + board + ": " + counted(topics.size(), "retained topic") + " cleared");
    return program::kExitOk;
}

int run_prune(const PruneOptions& options, Context& context) {
    BusSession session(context);
    BoardSource source(context, session);
    if (const auto connected = session.connect(); !connected) return context.fail_with(connected.error());
    auto lingering =
        find_lingering(context.topics, read_retained(context, session, {context.topics.root() + "/#"}));
    std::erase_if(lingering, [&](const Lingering& one) {
        const auto& kinds = options.kinds;
        return !kinds.empty() && std::find(kinds.begin(), kinds.end(), kind_name(one.kind)) == kinds.end();
    });
    print_lingering(lingering, options.output, context);
    if (options.dry_run || lingering.empty()) {
        context.note(lingering.empty() ? "nothing lingers"
                                       : "would clear " + counted(lingering.size(), "retained topic"));
        return program::kExitOk;
    }
    const int status = tell_registry_of_all(context, session, source, lingering);
    std::vector<std::string> topics;
    for (const auto& one : lingering)
        topics.push_back(one.topic);
    if (const auto cleared = clear_retained(context, session, topics); !cleared)
        return context.fail_with(cleared.error());
    context.note("cleared " + counted(topics.size(), "retained topic"));
    return status;
}

void setup_forget(CLI::App& app, Chosen& chosen) {
    auto* command = app.add_subcommand("forget", "Clear everything that is kept of a board that is gone");
    command->fallthrough();
    auto options = std::make_shared<ForgetOptions>();
    command->add_option("board", options->board, "Name of the board")->required()->type_name("");
    command->add_flag("--dry-run", options->dry_run, "Only show what would be cleared");
    command->add_flag("--force", options->force, "Also a board that seems alive");
    add_output_option(*command, options->output, {Output::kText, Output::kJsonLines});
    command->footer("Prints the topics that are cleared.\nExample:\n  asipctl forget uno7");
    command->callback([&chosen, options] {
        chosen = [options](Context& context) { return run_forget(*options, context); };
    });
}

void setup_prune(CLI::App& app, Chosen& chosen) {
    auto* command = app.add_subcommand("prune", "Clear everything retained that nobody needs any more");
    command->fallthrough();
    auto options = std::make_shared<PruneOptions>();
    command->add_flag("--dry-run", options->dry_run, "Only show what would be cleared");
    command
        ->add_option("--only", options->kinds,
                     "boards (gone), commands (retained), orphans, names (illegal), registries (gone)")
        ->delimiter(',')
        ->check(CLI::IsMember({"boards", "commands", "orphans", "names", "registries"}))
        ->type_name("KIND");
    add_output_option(*command, options->output, {Output::kTable, Output::kJsonLines, Output::kName});
    command->footer("Examples:\n  asipctl prune --dry-run\n  asipctl prune --only commands");
    command->callback([&chosen, options] {
        chosen = [options](Context& context) { return run_prune(*options, context); };
    });
}

}  // namespace asip::cli
