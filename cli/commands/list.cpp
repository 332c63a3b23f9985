#include "cli/commands/list.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/board_state.hpp"
#include "asip/model/json.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/nearest.hpp"
#include "cli/board_source.hpp"
#include "cli/command.hpp"
#include "cli/commands/watch.hpp"

namespace asip::cli {
namespace {

std::string seen_text(double age) {
    return age < 0 ? std::string("-") : text::duration_text(std::chrono::duration<double>(age)) + " ago";
}

template <class Item>
std::string json_text(const std::vector<Item>& items, Output output) {
    if (output == Output::kJsonLines) {
        std::string text;
        for (const auto& item : items)
            text += model::dump_json(bus::to_json(item)) + "\n";
        return text;
    }
    auto array = nlohmann::json::array();
    for (const auto& item : items)
        array.push_back(bus::to_json(item));
    return model::dump_json_pretty(array) + "\n";
}

std::string number_text(const std::optional<int>& number) {
    return number ? std::to_string(*number) : "";
}

int show_all(const ListOptions& options, Context& context, BoardSource& source) {
    const bool table = options.output == Output::kTable || options.output == Output::kWide;
    if (options.services) {
        const auto found = source.services(options.query);
        if (!found) return context.fail_with(found.error());
        if (found->empty() && table) context.note("no service matches");
        context.out << services_text(*found, options.output, context.width, context.colour) << std::flush;
        return program::kExitOk;
    }
    if (options.output == Output::kTable || options.output == Output::kName) {
        const auto found = source.brief_boards(options.query);
        if (!found) return context.fail_with(found.error());
        if (found->empty() && table) context.note("no board matches");
        context.out << brief_text(*found, options.output, context.width, context.colour) << std::flush;
        return program::kExitOk;
    }
    const auto found = source.boards(options.query);
    if (!found) return context.fail_with(found.error());
    if (found->empty() && table) context.note("no board matches");
    context.out << boards_text(*found, options.output, context.width, context.colour) << std::flush;
    return program::kExitOk;
}

}  // namespace

Colour state_colour(const std::string& state) {
    if (state == "online") return Colour::kGreen;
    if (state == "lost") return Colour::kRed;
    if (state == "sleeping" || state == "updating") return Colour::kYellow;
    return Colour::kDim;
}

Table board_table(bool wide) {
    std::vector<Column> columns{
        {"BOARD"}, {"STATE"}, {"CHIP", false, 6}, {"SKETCH", false, 6}, {"SERVICES", false, 10}, {"SEEN"}};
    if (wide) {
        columns.insert(columns.end(),
                       {{"PROTOCOL"}, {"LEASE", true}, {"LINK", false, 8}, {"AGENT", false, 8}, {"SESSION"}});
    }
    return Table(std::move(columns));
}

std::vector<Cell> brief_row(const bus::BriefBoard& board) {
    std::vector<Cell> row;
    row.reserve(6);
    row.emplace_back(board.board);
    if (board.conflict) {
        row.emplace_back(board.state + "!", Colour::kRed);
    } else {
        row.emplace_back(board.state, state_colour(board.state));
    }
    row.emplace_back(board.chip);
    row.emplace_back(board.sketch);
    row.emplace_back(board.services);
    row.emplace_back(seen_text(board.age));
    return row;
}

std::vector<Cell> board_row(const bus::BoardItem& board, bool wide) {
    auto row = brief_row(bus::brief_of(board));
    if (!wide) return row;
    const auto lease =
        board.lease > 0 ? text::duration_text(std::chrono::duration<double>(board.lease)) : std::string();
    for (const auto& text : {board.protocol, lease, board.link, board.agent, board.session})
        row.emplace_back(text);
    return row;
}

Table service_table(bool wide) {
    std::vector<Column> columns{{"BOARD"},       {"SERVICE"},      {"KIND"}, {"TITLE", false, 8},
                                {"COUNT", true}, {"PERIOD", true}, {"STATE"}};
    if (wide) columns.insert(columns.end(), {{"ID"}, {"MODEL"}});
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
    if (wide) row.insert(row.end(), {service.id, service.model});
    return row;
}

std::string boards_text(const std::vector<bus::BoardItem>& boards, Output output, std::size_t width,
                        bool colour) {
    if (output == Output::kJson || output == Output::kJsonLines) return json_text(boards, output);
    const bool wide = output == Output::kWide;
    if (!wide) {
        std::vector<bus::BriefBoard> rows;
        for (const auto& board : boards)
            rows.push_back(bus::brief_of(board));
        return brief_text(rows, output, width, colour);
    }
    if (boards.empty()) return {};
    auto table = board_table(wide);
    for (const auto& board : boards)
        table.add(board_row(board, wide));
    return table.render(0, colour);
}

std::string brief_text(const std::vector<bus::BriefBoard>& boards, Output output, std::size_t width,
                       bool colour) {
    std::string text;
    if (output == Output::kName) {
        for (const auto& board : boards)
            text.append(board.board).append("\n");
        return text;
    }
    if (boards.empty()) return text;
    auto table = board_table(false);
    for (const auto& board : boards)
        table.add(brief_row(board));
    return table.render(width, colour);
}

std::string services_text(const std::vector<bus::ServiceItem>& services, Output output, std::size_t width,
                          bool colour) {
    if (output == Output::kJson || output == Output::kJsonLines) return json_text(services, output);
    if (output == Output::kName) {
        std::string text;
        for (const auto& service : services)
            text += service.board + "/" + service.name + "\n";
        return text;
    }
    if (services.empty()) return {};
    const bool wide = output == Output::kWide;
    auto table = service_table(wide);
    for (const auto& service : services)
        table.add(service_row(service, wide));
    return table.render(wide ? 0 : width, colour);
}

int run_list(const ListOptions& options, Context& context) {
    if (options.watch) return run_watch(options, context);
    BusSession session(context);
    BoardSource source(context, session);
    if (const auto connected = session.connect(); !connected) return context.fail_with(connected.error());
    return show_all(options, context, source);
}

void setup_list(CLI::App& app, Chosen& chosen) {
    auto* command = app.add_subcommand("list", "Boards or services on the bus");
    command->fallthrough();
    auto options = std::make_shared<ListOptions>();
    auto what = std::make_shared<std::string>("boards");
    command->add_option("what", *what, "boards (the default) or services")
        ->check(CLI::IsMember({"boards", "services"}))
        ->type_name("");
    command->add_option("--board", options->query.board, "Only boards of this name; * and ? as in a shell")
        ->type_name("PATTERN");
    command->add_option("--kind", options->query.kind, "Only with such a service: distance, servo, ...")
        ->delimiter(',')
        ->type_name("KIND");
    command->add_option("--state", options->query.state, "online, offline, lost, sleeping or updating")
        ->delimiter(',')
        ->check(CLI::IsMember({"online", "offline", "lost", "sleeping", "updating"}))
        ->type_name("STATE");
    command
        ->add_option("--unit", options->query.unit,
                     "Only with a service that measures or takes this unit: cm, ms, ...")
        ->type_name("UNIT");
    command->add_option("--chip", options->query.chip, "Only with this micro-controller")
        ->type_name("PATTERN");
    command->add_option("--sketch", options->query.sketch, "Only with this sketch")->type_name("PATTERN");
    command
        ->add_option("--capability", options->query.capability,
                     "Only with a pin that can do this: digital, analog, pwm")
        ->check(CLI::IsMember({"digital", "analog", "pwm"}))
        ->type_name("WORD");
    command->add_flag("-w,--watch", options->watch, "Go on and show what changes, until Ctrl-C");
    add_output_option(*command, options->output,
                      {Output::kTable, Output::kWide, Output::kJson, Output::kJsonLines, Output::kName});
    command->footer(
        "Examples:\n"
        "  asipctl list\n"
        "  asipctl list services --kind distance,servo\n"
        "  asipctl list --state lost -o name\n"
        "  asipctl list -w -o jsonl | jq .board");
    command->callback([&chosen, options, what] {
        chosen = [options, what](Context& context) {
            options->services = *what == "services";
            return run_list(*options, context);
        };
    });
}

}  // namespace asip::cli
