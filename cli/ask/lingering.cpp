// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/lingering.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>

#include "cli/ask/board_source.hpp"
#include "cli/ask/forget_request.hpp"
#include "cli/ask/retained.hpp"
#include "cli/text/table.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

std::string kind_name(Lingering::Kind kind) {
    switch (kind) {
        case Lingering::Kind::kGoneBoard:
            return "boards";
        case Lingering::Kind::kCommand:
            return "commands";
        case Lingering::Kind::kOrphan:
            return "orphans";
        case Lingering::Kind::kInvalidName:
            return "names";
        case Lingering::Kind::kUnreadable:
            return "documents";
        case Lingering::Kind::kGoneRegistry:
            break;
    }
    return "registries";
}

void print_lingering(const std::vector<Lingering>& all, const OutputOptions& output,
                     Environment& environment) {
    Table table({{"TOPIC", false, 20}, {"KIND"}, {"WHY", false, 10}});
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    for (const auto& one : all) {
        if (!output.for_people()) {
            records.print({{"topic", one.topic},
                           {"kind", kind_name(one.kind)},
                           {"board", one.board},
                           {"why", one.why}});
        } else if (output.form == Output::kName) {
            environment.say(one.topic);
        } else {
            table.add({one.topic, kind_name(one.kind), one.why});
        }
    }
    if (!table.empty()) environment.out << table.render(environment.width, environment.colour);
    if (!output.for_people()) records.finish();
    environment.out << std::flush;
}

/// Boards that a registry will not forget (they just came back, for one) are taken out of `lingering`.
int forget_boards(Environment& environment, BusSession& session, BoardSource& source,
                  std::vector<Lingering>& lingering) {
    std::set<std::string> boards;
    for (const auto& one : lingering)
        if (one.kind == Lingering::Kind::kGoneBoard) boards.insert(one.board);
    const auto asked = ask_to_forget(environment, session, source, {boards.begin(), boards.end()});
    std::erase_if(lingering, [&asked](const Lingering& one) { return asked.refused.contains(one.board); });
    return asked.status;
}

}  // namespace

int clear_lingering(const LingeringOptions& options, Environment& environment) {
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    const auto retained = read_retained(environment, session, {environment.topics.root() + "/#"});
    if (!retained) return environment.fail_with(retained.error());
    auto lingering = find_lingering(environment.topics, *retained);
    std::erase_if(lingering, [&](const Lingering& one) {
        const auto& kinds = options.kinds;
        return !kinds.empty() && std::find(kinds.begin(), kinds.end(), kind_name(one.kind)) == kinds.end();
    });
    print_lingering(lingering, options.output, environment);
    if (options.dry_run || lingering.empty()) {
        environment.note(lingering.empty() ? "nothing to clear"
                                           : "would clear " + counted(lingering.size(), "retained topic"));
        return program::kExitOk;
    }
    const int status = forget_boards(environment, session, source, lingering);
    std::vector<std::string> topics;
    for (const auto& one : lingering)
        topics.push_back(one.topic);
    if (const auto cleared = clear_retained(environment, session, topics); !cleared)
        return environment.fail_with(cleared.error());
    environment.note("cleared " + counted(topics.size(), "retained topic"));
    return status;
}

}  // namespace asip::cli
