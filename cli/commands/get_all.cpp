// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/get_all.hpp"

#include <algorithm>
#include <list>
#include <memory>
#include <ostream>

#include "asip/bus/registry/board_match.hpp"
#include "asip/property/words.hpp"
#include "asip/text/duration.hpp"
#include "cli/ask/board_values.hpp"
#include "cli/find/target.hpp"
#include "cli/text/table.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// Values that have not come by then are shown as unknown.
constexpr Duration kPatience = 2s;
class AllValues : OnTheBus {
  public:
    AllValues(const GetOptions& options, Target target, bus::LabelSelector labels, Environment& environment)
        : OnTheBus(environment), options_(options), target_(std::move(target)), labels_(std::move(labels)) {}

    int run() {
        if (const auto status = connect()) return *status;
        if (const auto found = find(); !found) return environment_.fail_with(found.error());
        const auto services = target_.service.empty() ? std::string("*") : target_.service;
        for (auto& board : boards_)
            board.values = std::make_unique<BoardValues>(environment_, session_, board.known, services);
        session_.run_until(
            [this] {
                return std::all_of(boards_.begin(), boards_.end(),
                                   [](const Board& board) { return board.values->complete(); });
            },
            Clock::now() + std::min<Duration>(environment_.timeout, kPatience));
        return show();
    }

  private:
    struct Board {
        KnownBoard known;
        std::unique_ptr<BoardValues> values{};
    };

    Outcome<void> find() {
        auto boards = choose_boards(source_, target_, labels_);
        if (!boards) return tl::unexpected(boards.error());
        for (auto& board : *boards)
            if (board.item.state == "online" && board.description)
                boards_.emplace_back(Board{std::move(board)});
            else
                environment_.note(board.item.board + ": no values: it is " + board.item.state);
        if (boards_.empty()) return failure(program::kExitNoAnswer, "none of these boards is there");
        return {};
    }

    int show() {
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"PROPERTY"}, {"NAME"}, {"VALUE", false, 10}, {"HOW"}, {"AGE", true}});
        bool any = false, answered = false;
        for (const auto& board : boards_) {
            answered = answered || board.values->answered();
            for (std::size_t i = 0; i < board.values->properties().size(); ++i) {
                const auto shown = board.values->of(i);
                any = true;
                note_refused(environment_, board.known.item.board, board.values->properties()[i]);
                if (options_.output.for_people())
                    table.add(value_row(board.known.item.board, board.values->properties()[i], shown,
                                        options_.raw));
                else
                    records.print(value_record(board.known.item.board, board.values->properties()[i], shown));
            }
        }
        records.finish();
        if (!table.empty())
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        if (!answered)
            return environment_.fail_with(session_.unanswered(
                any ? "no agent said how its board stands, only what was reported meanwhile is shown"
                    : "no agent of these boards answers; does it run? Try: asipctl doctor"));
        if (!any) environment_.note("nothing of these boards can be read or set, as far as their models say");
        return program::kExitOk;
    }

    const GetOptions& options_;
    const Target target_;
    const bus::LabelSelector labels_;
    std::list<Board> boards_;
};

}  // namespace

std::vector<Cell> value_row(const std::string& board, const property::Property& property,
                            const property::ShownValue& shown, bool raw) {
    const bool known = shown.how != property::How::kNone;
    return {board + "/" + property.id, for_terminal(property.name),
            for_terminal(known ? property::value_text(property, shown.value, raw)
                               : property::unknown_text(shown.why)),
            known ? std::string(property::to_text(shown.how)) : std::string(),
            known ? text::duration_text(std::chrono::duration<double>(shown.age)) : std::string()};
}

void note_refused(Environment& environment, const std::string& board, const property::Property& property) {
    if (!property.refused.empty())
        environment.note(board + "/" + property.id + " cannot be set: " + property.refused);
}

nlohmann::json value_record(const std::string& board, const property::Property& property,
                            const property::ShownValue& shown) {
    nlohmann::json record{{"board", board},
                          {"service", property.service},
                          {"property", property.id},
                          {"name", property.name},
                          {"how", property::to_text(shown.how)}};
    if (!property.unit.empty()) record["unit"] = property.unit;
    if (!property.refused.empty()) record["refused"] = property.refused;
    for (const auto& event : shown.events)
        record["events"].push_back(property::to_text(event.act));
    if (shown.how == property::How::kNone) {
        record["unknown"] = property::to_text(shown.why);
        return record;
    }
    record["value"] = shown.value;
    record["age"] = shown.age;
    return record;
}

int run_get_all(const GetOptions& options, Environment& environment) {
    auto labels = parse_selector(options.selector);
    if (!labels) return environment.fail_with(labels.error());
    auto target = parse_target(options.target.empty() ? "*" : options.target, true);
    if (!target) return environment.fail_with(target.error());
    return AllValues(options, std::move(*target), std::move(*labels), environment).run();
}

}  // namespace asip::cli
