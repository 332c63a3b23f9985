// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/show.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/bus/registry/board_match.hpp"
#include "asip/model/json.hpp"
#include "asip/property/documents.hpp"
#include "cli/ask/retained.hpp"
#include "cli/declaration.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {
namespace {

KnownProperties read_properties(const Environment& environment, BusSession& session,
                                const std::string& board) {
    const auto list_topic = environment.topics.properties(board);
    const auto retained = read_retained(environment, session, {list_topic, environment.topics.values(board)});
    if (!retained || retained->size() != 2) return {};
    const bool list_first = retained->front().topic == list_topic;
    auto list = property::parse_list(retained->at(list_first ? 0 : 1).payload);
    const auto values = property::parse_values(retained->at(list_first ? 1 : 0).payload);
    KnownProperties result;
    if (!list || !values) return result;
    for (auto& property : list->properties)
        if (const auto found = values->values.find(property.id);
            found != values->values.end() && found->second.how != property::How::kNone)
            result.emplace_back(std::move(property), found->second.value);
    return result;
}

nlohmann::json board_json(const KnownBoard& board, const KnownProperties& known) {
    auto result = bus::to_json(board.item);
    if (board.description) result["description"] = model::to_json(*board.description);
    if (!board.description_fault.empty()) result["description_fault"] = board.description_fault;
    for (const auto& [property, value] : known)
        result["values"][property.id] = value;
    return result;
}

nlohmann::json service_json(const KnownBoard& board, const model::ServiceInfo& service,
                            const model::ServiceModel* model, const KnownProperties& known) {
    auto result = nlohmann::json::object();
    for (const auto& item : board.item.services)
        if (item.name == service.name) result = bus::to_json(item);
    if (model != nullptr) {
        if (auto source = model::parse_json(model->source)) result["definition"] = std::move(*source);
    }
    for (const auto& [property, value] : known)
        if (property.service == service.name) result["values"][property.id] = value;
    return result;
}

}  // namespace

int run_show(const ShowOptions& options, Environment& environment) {
    const auto target = parse_target(options.target);
    if (!target) return environment.fail_with(target.error());
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    auto board = source.board_in_full(target->board);
    if (!board) return environment.fail_with(board.error());
    // What its agent announced names the program that has its port; a registry's answer does not.
    if (board->item.state == "updating") {
        if (auto retained = source.retained_board(target->board))
            board->item.description = std::move(retained->item.description);
    }
    const auto known = read_properties(environment, session, target->board);
    const bool people = options.output.for_people();
    RecordPrinter records(options.output, RecordPrinter::Count::kOne, environment.out);
    if (target->service.empty()) {
        if (!people) records.print(board_json(*board, known));
        if (people)
            environment.out << board_text(*board, environment.models(), environment.width, environment.colour,
                                          known)
                            << std::flush;
        return program::kExitOk;
    }
    const auto service = find_service(*board, target->service);
    if (!service) return environment.fail_with(service.error());
    const auto model = bus::model_of(*service, environment.models());
    if (!people) records.print(service_json(*board, *service, model.get(), known));
    const auto label = board->description ? board->description->labels.service(service->name) : std::string();
    if (people)
        environment.out << service_text(target->board, *service, label, model.get(), environment.width,
                                        environment.colour, known)
                        << std::flush;
    return program::kExitOk;
}

namespace {

Run declare_show(Declaration& verb) {
    auto options = std::make_shared<ShowOptions>();
    verb.argument("BOARD[/SERVICE]", options->target, "Which");
    verb.output(options->output, {Output::kText},
                {"board",  "state", "chip",     "sketch",      "protocol",          "lease",
                 "link",   "agent", "services", "description", "description_fault", "name",
                 "kind",   "title", "count",    "period",      "definition",        "label",
                 "labels", "names", "values",   "version",     "available"});
    return [options](Environment& environment) { return run_show(*options, environment); };
}

}  // namespace

Verb show_verb() {
    return {"show", "Everything known of a board or of one of its services",
            "Examples:\n"
            "  asipctl show uno1\n"
            "  asipctl show uno1/servo\n"
            "  asipctl show uno1 -o json | jq .description.pins\n"
            "  asipctl show uno1 --format '{chip} {description.firmware.sketch}'",
            declare_show};
}

}  // namespace asip::cli
