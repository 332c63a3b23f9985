// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/bus/pattern.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/events/change_record.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {
namespace {

struct HistoryOptions {
    std::string board;
    bool all = false;
    std::size_t count = 20;
    OutputOptions output{Output::kTable, {}};
};

void print_changes(const std::vector<bus::HistoryItem>& changes, const OutputOptions& output,
                   Environment& environment) {
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    auto table = change_table();
    for (const auto& change : changes) {
        if (output.for_people()) {
            table.add(change_row(change));
        } else {
            records.print(bus::to_json(change));
        }
    }
    if (!output.for_people()) return records.finish();
    if (table.empty()) return environment.note("nothing is known of it");
    environment.out << table.render(environment.width, environment.colour) << std::flush;
}

int run_history(const HistoryOptions& options, Environment& environment) {
    if (options.board.empty() != options.all) {
        return environment.fail_with({program::kExitUsage, "name a board, or write --all"});
    }
    bus::Query query;
    if (!options.all) {
        const auto valid = check_board_pattern(options.board, "history");
        if (!valid) return environment.fail_with(valid.error());
        query.board = options.board;
    }
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    auto changes = source.history(query, options.count);
    if (!changes) return environment.fail_with(changes.error());
    if (changes->empty() && !options.all) {
        const auto names = source.names();
        const auto is_it = [&](const std::string& name) { return bus::matches_pattern(query.board, name); };
        if (std::none_of(names.begin(), names.end(), is_it))
            return environment.fail_with(no_such_board(query.board, names));
    }
    // A registry gives the newest first.
    std::reverse(changes->begin(), changes->end());
    print_changes(*changes, options.output, environment);
    return program::kExitOk;
}

Run declare_history(Declaration& verb) {
    auto options = std::make_shared<HistoryOptions>();
    verb.argument("PATTERN", options->board, "Which board; * and ? as in a shell", Declaration::Needed::kNo);
    verb.flag("--all", options->all, "Of all boards");
    verb.option("-n,--count", "COUNT", options->count, "The newest so many", 1, 100'000);
    verb.output(options->output, {Output::kTable}, change_fields());
    return [options](Environment& environment) { return run_history(*options, environment); };
}

}  // namespace

Verb history_verb() {
    return {"history", "When boards came, left and changed, and which user sent which command, oldest first",
            "From a registry that keeps a history: asip-registry --history FILE.\n"
            "Examples:\n"
            "  asipctl history uno1\n"
            "  asipctl history --all -n 100 -o jsonl",
            declare_history};
}

}  // namespace asip::cli
