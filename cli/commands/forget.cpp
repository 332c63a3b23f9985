// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/forget.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/protocol/request.hpp"
#include "asip/text/nearest.hpp"
#include "cli/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/forget_request.hpp"
#include "cli/retained.hpp"
#include "cli/target.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

/// Whether an agent (or the board itself) still answers for it, whatever is retained.
bool answers(Context& context, BusSession& session, const std::string& board) {
    bool heard = false;
    const auto hear = [&heard](const mqtt::Message& message) { heard = heard || !message.retain; };
    const auto description = session.subscribe(context.topics.description(board), hear, {.retained = false});
    const auto reports = session.subscribe(context.topics.board_out(board), hear, {.retained = false});
    const auto request = session.ask(context.topics.board_in(board), std::string(protocol::kAskInfo), hear);
    session.publish(context.topics.probe(), board);
    session.run_until([&heard] { return heard; }, Clock::now() + kProbeWindow);
    return heard;
}

void print_topics(const std::vector<std::string>& topics, const OutputOptions& output, Context& context) {
    RecordPrinter records(output, RecordPrinter::Count::kList, context.out);
    for (const auto& topic : topics) {
        if (output.for_people()) {
            context.out << topic << '\n';
        } else {
            records.print({{"topic", topic}});
        }
    }
    records.finish();
}

int nobody_knows(Context& context, BoardSource& source, const std::string& board) {
    return context.fail_with({program::kExitFailure, "unknown board \"" + board + "\"" +
                                                         text::did_you_mean(board, source.names()) +
                                                         ": nothing is retained of it; see asipctl list"});
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
        if (topics.empty()) return nobody_knows(context, source, board);
        print_topics(topics, options.output, context);
        context.note("would clear " + counted(topics.size(), "retained topic"));
        return program::kExitOk;
    }
    auto registry = Forgotten::kNoRegistry;
    if (!options.force) {
        const auto asked = ask_to_forget(context, session, source, board);
        if (!asked) return context.fail_with(asked.error());
        registry = *asked;
    }
    if (topics.empty() && registry != Forgotten::kYes) return nobody_knows(context, source, board);
    if (const auto cleared = clear_retained(context, session, topics); !cleared)
        return context.fail_with(cleared.error());
    print_topics(topics, options.output, context);
    context.note("forgot " + board + ": " + counted(topics.size(), "retained topic") + " cleared");
    return program::kExitOk;
}

namespace {

Run declare_forget(Declaration& verb) {
    auto options = std::make_shared<ForgetOptions>();
    verb.argument("BOARD", options->board, "Name of the board");
    verb.flag("--dry-run", options->dry_run, "Only show what would be cleared");
    verb.flag("--force", options->force, "Also a board that seems alive");
    verb.output(options->output, {Output::kText}, {"topic"});
    return [options](Context& context) { return run_forget(*options, context); };
}

}  // namespace

Verb forget_verb() {
    return {"forget", "Clear everything that is kept of a board that is gone",
            "Prints the topics that are cleared.\nExample:\n  asipctl forget uno7", declare_forget};
}

}  // namespace asip::cli
