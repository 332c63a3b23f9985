// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/list.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "asip/text/duration.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/declaration.hpp"
#include "cli/flash/no_asip.hpp"
#include "cli/text/state_text.hpp"
#include "cli/text/width.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

std::string ago_text(double age) {
    return age < 0 ? std::string("-") : text::duration_text(std::chrono::duration<double>(age)) + " ago";
}

template <class Item>
void print_records(const std::vector<Item>& items, const OutputOptions& output, Environment& environment) {
    RecordPrinter records(output, RecordPrinter::Count::kList, environment.out);
    for (const auto& item : items)
        records.print(bus::to_json(item));
    records.finish();
}

std::string labels_text(const model::Labels& labels) {
    return listed(labels.labels, ",", [](const auto& each) { return each.first + "=" + each.second; });
}

std::string number_text(const std::optional<int>& number) {
    return number ? std::to_string(*number) : "";
}

using SortKey = std::pair<double, std::string>;

template <class Board>
SortKey board_key(const Board& board, const std::string& by) {
    if (by == "announced") return {board.age < 0 ? std::numeric_limits<double>::max() : board.age, {}};
    return {0, std::string(by == "state"    ? board.state
                           : by == "chip"   ? board.chip
                           : by == "sketch" ? board.sketch
                                            : std::string_view())};
}

SortKey sort_key(const bus::BriefBoard& board, const std::string& by) {
    return board_key(board, by);
}
SortKey sort_key(const bus::BoardItem& board, const std::string& by) {
    return board_key(board, by);
}
SortKey sort_key(const bus::ServiceItem& service, const std::string& by) {
    return {0, by == "state" ? service.state : by == "kind" ? service.kind : std::string()};
}

std::string name_key(const bus::BriefBoard& board) {
    return std::string(board.board);
}
std::string name_key(const bus::BoardItem& board) {
    return board.board;
}
std::string name_key(const bus::ServiceItem& service) {
    return service.board + "/" + service.name;
}

template <class Item>
void sort_items(std::vector<Item>& items, const std::string& by, bool reverse) {
    std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) {
        const auto left = std::make_pair(sort_key(a, by), name_key(a));
        const auto right = std::make_pair(sort_key(b, by), name_key(b));
        return reverse ? right < left : left < right;
    });
}

template <class Item, class Text>
int print_list(Outcome<std::vector<Item>> found, const ListOptions& options, Environment& environment,
               BusSession& session, const char* nothing, Text text) {
    const auto& output = options.output;
    if (!found) return environment.fail_with(found.error());
    session.leave();
    // They come sorted by name.
    if (options.sort != "name" || options.reverse) sort_list(*found, options.sort, options.reverse);
    if (!output.for_people()) {
        print_records(*found, output, environment);
        return program::kExitOk;
    }
    if (found->empty() && output.form != Output::kName) environment.note(nothing);
    environment.out << text(*found, output.form, environment.width, environment.colour) << std::flush;
    return program::kExitOk;
}

/// The same of rows that hold what a table shows, and no more.
int print_brief(Outcome<bus::BriefRows> found, const ListOptions& options, Environment& environment,
                BusSession& session, const char* nothing) {
    const auto form = options.output.form;
    if (!found) return environment.fail_with(found.error());
    session.leave();
    if (options.sort != "name" || options.reverse) sort_list(*found, options.sort, options.reverse);
    if (found->empty() && form != Output::kName) environment.note(nothing);
    environment.out << brief_text(*found, form, environment.width, environment.colour) << std::flush;
    return program::kExitOk;
}

int show_all(const ListOptions& options, Environment& environment, BusSession& session, BoardSource& source) {
    const auto& output = options.output;
    if (options.services())
        return print_list(source.services(options.query), options, environment, session, "no service matches",
                          services_text);
    const auto& query = options.query;
    const bool all = (query.board.empty() || query.board == "*") && query.service.empty() &&
                     query.kind.empty() && query.state.empty() && query.chip.empty() &&
                     query.sketch.empty() && query.unit.empty() && query.capability.empty() &&
                     query.labels.empty();
    const char* const none = all ? "there is no board" : "no board matches";
    if (output.form == Output::kWide || !output.for_people())
        return print_list(source.boards(options.query), options, environment, session, none, boards_text);
    return print_brief(source.brief_boards(options.query), options, environment, session, none);
}

const std::vector<std::string> kListFields{
    "board",      "state",     "reported", "chip",       "sketch",  "protocol", "lease", "age",
    "link",       "agent",     "session",  "services",   "name",    "kind",     "title", "count",
    "label",      "labels",    "names",    "reason",     "period",  "id",       "model", "since",
    "first_seen", "last_seen", "conflict", "names_only", "version", "available"};

}  // namespace

Colour state_colour(std::string_view state) {
    if (state == "online") return Colour::kGreen;
    if (state == "lost") return Colour::kRed;
    if (state == "sleeping" || state == "updating") return Colour::kYellow;
    return Colour::kDim;
}

Cell state_cell(const bus::BriefBoard& board) {
    if (speaks_no_asip(board)) return {"no ASIP sketch yet", Colour::kYellow};
    return {state_text(board.state, board.reason, board.state_age), state_colour(board.state)};
}

Table board_table(bool wide) {
    std::vector<Column> columns{
        {"BOARD"},    {"STATE", false, 7}, {"CHIP", false, 6}, {"SKETCH", false, 6}, {"SERVICES", false, 10},
        {"ANNOUNCED"}};
    if (wide) {
        columns.insert(columns.end(), {{"LABELS", false, 8},
                                       {"PROTOCOL"},
                                       {"LEASE", true},
                                       {"LINK", false, 8},
                                       {"AGENT", false, 8},
                                       {"SESSION"}});
    }
    return Table(std::move(columns));
}

void add_board(Table& table, const bus::BriefBoard& board, const bus::BriefBoard* above) {
    table.add_cell(board.board);
    if (board.conflict) {
        table.add_cell(std::string(board.state) + "!", Colour::kRed);
    } else {
        const auto state = state_cell(board);
        table.add_cell(state.text, state.colour);
    }
    if (above != nullptr && board.like(*above)) {
        table.add_cells_above(3);
    } else {
        table.add_cell(board.chip);
        table.add_cell(board.sketch);
        table.add_cell(board.services);
    }
    table.add_cell(ago_text(board.age));
}

void add_board(Table& table, const bus::BoardItem& board, bool wide) {
    add_board(table, bus::brief_of({&board, 1}).rows().front(), nullptr);
    if (!wide) return;
    const auto lease =
        board.lease > 0 ? text::duration_text(std::chrono::duration<double>(board.lease)) : std::string();
    for (const auto& text :
         {labels_text(board.labels), board.protocol, lease, board.link, board.agent, board.session})
        table.add_cell(text);
}

Table service_table(bool wide) {
    std::vector<Column> columns{{"BOARD"},       {"SERVICE"},      {"KIND"}, {"TITLE", false, 8},
                                {"COUNT", true}, {"PERIOD", true}, {"STATE"}};
    if (wide) columns.insert(columns.end(), {{"NAME", false, 8}, {"ID"}, {"MODEL"}});
    return Table(std::move(columns));
}

std::vector<Cell> service_row(const bus::ServiceItem& service, bool wide) {
    const auto period = service.period ? std::to_string(*service.period) + " ms" : std::string();
    std::vector<Cell> row{service.board,
                          service.name,
                          service.kind,
                          service.title,
                          number_text(service.count),
                          period,
                          Cell(service.state, state_colour(service.state))};
    if (wide) row.insert(row.end(), {service.label, service.id, service.model});
    return row;
}

std::string boards_text(const std::vector<bus::BoardItem>& boards, Output output, std::size_t width,
                        bool colour) {
    if (output != Output::kWide) return brief_text(bus::brief_of(boards), output, width, colour);
    if (boards.empty()) return {};
    auto table = board_table(true);
    for (const auto& board : boards)
        add_board(table, board, true);
    return table.render(0, colour);
}

std::string brief_text(const bus::BriefRows& boards, Output output, std::size_t width, bool colour) {
    std::string text;
    if (output == Output::kName) {
        for (const auto& board : boards.rows())
            text.append(for_terminal(board.board)).append("\n");
        return text;
    }
    if (boards.empty()) return text;
    auto table = board_table(false);
    table.reserve(boards.size());
    const bus::BriefBoard* above = nullptr;
    for (const auto& board : boards.rows())
        add_board(table, board, std::exchange(above, &board));
    return table.render(width, colour);
}

std::string services_text(const std::vector<bus::ServiceItem>& services, Output output, std::size_t width,
                          bool colour) {
    if (output == Output::kName) {
        std::string text;
        for (const auto& service : services)
            text += for_terminal(service.board + "/" + service.name) + "\n";
        return text;
    }
    if (services.empty()) return {};
    const bool wide = output == Output::kWide;
    auto table = service_table(wide);
    for (const auto& service : services)
        table.add(service_row(service, wide));
    return table.render(wide ? 0 : width, colour);
}

void sort_list(bus::BriefRows& boards, const std::string& by, bool reverse) {
    sort_items(boards.rows(), by, reverse);
}
void sort_list(std::vector<bus::BoardItem>& boards, const std::string& by, bool reverse) {
    sort_items(boards, by, reverse);
}
void sort_list(std::vector<bus::ServiceItem>& services, const std::string& by, bool reverse) {
    sort_items(services, by, reverse);
}

int run_list(const ListOptions& given, Environment& environment) {
    auto selector = parse_selector(given.selector);
    if (!selector) return environment.fail_with(selector.error());
    ListOptions options = given;
    options.query.labels = std::move(*selector);
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    return show_all(options, environment, session, source);
}

namespace {

Run declare_list(Declaration& verb) {
    auto options = std::make_shared<ListOptions>();
    auto& query = options->query;
    verb.argument("boards|services", options->what, "Which list; default boards", Declaration::Needed::kNo);
    verb.option("--board", "PATTERN", query.board, "Only boards of this name; * and ? as in a shell");
    verb.option("--kind", "KIND", query.kind, "Only with such a service: distance, servo, ...");
    verb.option("--state", "online|offline|lost|sleeping|updating", query.state,
                "Only in one of these states");
    verb.option("--unit", "UNIT", query.unit, "Only with a service that measures or takes this unit");
    verb.option("--chip", "CHIP", query.chip, "Only with this micro-controller; * and ? as in a shell");
    verb.option("--sketch", "SKETCH", query.sketch, "Only with this sketch; * and ? as in a shell");
    verb.option("--capability", "digital|analog|pwm", query.capability, "Only with a pin that can do this");
    declare_selector(verb, options->selector);
    verb.option("--sort", "name|state|chip|sketch|kind|announced", options->sort,
                "What the list is sorted by");
    verb.flag("-r,--reverse", options->reverse, "Sort the other way round");
    verb.output(options->output, {Output::kTable, Output::kWide, Output::kName}, kListFields);
    return [options](Environment& environment) { return run_list(*options, environment); };
}

}  // namespace

Verb list_verb() {
    return {"list", "Boards or services on the bus",
            "ANNOUNCED is how long ago the board's agent last announced it (about each third of the lease).\n"
            "Examples:\n"
            "  asipctl list\n"
            "  asipctl list services --kind distance,servo\n"
            "  asipctl list -l room=lab,!old -o wide\n"
            "  asipctl list --state lost -o name\n"
            "  asipctl list --sort announced\n"
            "  asipctl list --format '{board} {chip}'",
            declare_list};
}

}  // namespace asip::cli
