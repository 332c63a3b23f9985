// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/watch.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <sstream>

#include "asip/bus/registry/board_match.hpp"
#include "asip/bus/registry/catalogue_view.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/text/state_text.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

/// Follows a registry: pages of a snapshot joined to its change events.
class RegistryWatch {
  public:
    RegistryWatch(Environment& environment, BusSession& session, bus::CatalogueView& view)
        : environment_(environment), session_(session), view_(view) {
        events_ =
            session_.subscribe(environment.topics.registry_events("+"), [this](const mqtt::Message& message) {
                if (const auto event = bus::parse_change_event(message.payload)) view_.event(*event);
            });
        session_.on_connection_change([this](bool connected, const std::string& why) {
            environment_.note(connected ? "connected again" : not_known_text(why));
            if (connected) view_.restart();
            asked_at_.reset();
        });
    }

    /// Asks for the next page when one is wanted and none is on its way.
    void step() {
        const auto query = view_.next_query();
        if (!query || (asked_at_ && Clock::now() - *asked_at_ < 2s)) return;
        if (asked_at_) view_.restart();
        asked_at_ = Clock::now();
        const auto topic = view_.registry().empty() ? environment_.topics.any_registry_query()
                                                    : environment_.topics.registry_query(view_.registry());
        request_ = session_.ask(topic, bus::encode(bus::RegistryRequest{*query, {}, {}}),
                                [this](const mqtt::Message& message) {
                                    const auto answer = bus::parse_answer(message.payload);
                                    request_.reset();
                                    if (answer && !view_.page(*answer)) view_.restart();
                                    asked_at_.reset();
                                });
    }

  private:
    Environment& environment_;
    BusSession& session_;
    bus::CatalogueView& view_;
    BusSession::Subscription events_;
    BusSession::Request request_;
    std::optional<Time> asked_at_;
};

bool wanted(const ListOptions& options, const bus::BoardItem& board, const Environment& environment) {
    // Of services each is judged when it is printed.
    std::optional<model::Description> description;
    if (!board.description.empty()) {
        if (auto parsed = model::parse_description(board.description)) description = std::move(*parsed);
    }
    return bus::board_matches(options.query, board, description ? &*description : nullptr,
                              environment.models());
}

int watch_registry(const ListOptions& options, Environment& environment, ChangePrinter& printer) {
    BusSession session(environment);
    session.tell_refused_subscriptions();
    bus::CatalogueView view(
        [&](const bus::CatalogueView::Change& change) {
            const bool gone = change.kind == bus::ChangeEvent::Kind::kForgotten;
            if (!gone && !wanted(options, change.board, environment)) return;
            environment.out << (gone ? printer.gone(change.board.board) : printer.changed(change.board))
                            << std::flush;
        },
        options.query.board);
    RegistryWatch watch(environment, session, view);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    while (!session.stopped()) {
        watch.step();
        session.run_until([&] { return view.needs_snapshot(); }, Clock::now() + 200ms);
        if (view.needs_snapshot()) session.run_for(5ms);
    }
    return program::kExitOk;
}

int watch_bus(const ListOptions& options, Environment& environment, ChangePrinter& printer) {
    BusSession session(environment);
    session.tell_refused_subscriptions();
    auto& view = session.boards();
    session.on_connection_change([&](bool connected, const std::string& why) {
        environment.note(connected ? "connected again" : not_known_text(why));
    });
    std::set<std::string> changed;
    session.on_board([&](const std::string& board, const mqtt::Message*) { changed.insert(board); });
    session.caller().watch_all();
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    session.publish(environment.topics.probe(), "");
    session.run_for(kRetainedPatience);
    while (!session.stopped()) {
        for (const auto& name : changed) {
            const auto board = view.board(name, catalogue::instant_now());
            if (!board) {
                environment.out << printer.gone(name) << std::flush;
            } else if (wanted(options, *board, environment)) {
                environment.out << printer.changed(*board) << std::flush;
            }
        }
        changed.clear();
        session.run_until([&] { return !changed.empty(); }, Clock::now() + 1h);
        // A description and a state that come together are one change.
        session.run_for(30ms);
    }
    return program::kExitOk;
}

/// Nothing: it is over, with `status`.
std::optional<std::string> registry_here(Environment& environment, int& status) {
    if (environment.from_bus) return "";
    BusSession session(environment);
    BoardSource source(environment, session);
    if (const auto connected = session.connect(); !connected) {
        status = environment.fail_with(connected.error());
        return std::nullopt;
    }
    auto registry = source.find_registry();
    if (session.stopped()) return std::nullopt;
    return registry;
}

}  // namespace

ChangePrinter::ChangePrinter(const ListOptions& options, std::size_t width, bool colour)
    : options_(options),
      width_(options.output.form == Output::kWide ? 0 : width),
      colour_(colour),
      table_(options.services() ? service_table(options.output.form == Output::kWide)
                                : board_table(options.output.form == Output::kWide)) {}

std::string ChangePrinter::records(const bus::BoardItem& board) const {
    std::ostringstream text;
    RecordPrinter printer(options_.output, RecordPrinter::Count::kStream, text);
    if (!options_.services()) {
        printer.print(bus::to_json(board));
    } else {
        for (const auto& service : board.services)
            printer.print(bus::to_json(service));
    }
    return text.str();
}

std::string ChangePrinter::rows(const bus::BoardItem& board) {
    const bool wide = options_.output.form == Output::kWide;
    if (options_.services()) {
        for (const auto& service : board.services)
            table_.add(service_row(service, wide));
    } else {
        add_board(table_, board, wide);
    }
    return std::exchange(first_, false) ? table_.render(width_, colour_)
                                        : table_.render_more(width_, colour_);
}

std::string ChangePrinter::names(const bus::BoardItem& board) const {
    if (!options_.services()) return for_terminal(board.board) + "\n";
    std::string text;
    for (const auto& service : board.services)
        text += for_terminal(board.board + "/" + service.name) + "\n";
    return text;
}

std::string ChangePrinter::changed(const bus::BoardItem& seen) {
    if (!model::valid_name(seen.board)) return {};  // it is not shown as text
    auto board = seen;
    std::erase_if(board.services, [](const auto& service) { return !model::valid_name(service.name); });
    auto essence = board;
    essence.age = 0;
    essence.seq = 0;
    essence.last_seen = {};
    essence.first_seen = essence.since = {};  // they differ by what clocks are read to
    essence.state_age = -1;
    essence.description.clear();
    auto text = model::dump_json(bus::to_json(essence));
    auto& shown = shown_[board.board];
    if (shown == text) return {};
    shown = std::move(text);
    if (!options_.output.for_people()) return records(board);
    if (options_.output.form == Output::kName) return names(board);
    return rows(board);
}

std::string ChangePrinter::gone(const std::string& board) {
    if (shown_.erase(board) == 0) return {};
    bus::BoardItem item;
    item.board = board;
    item.state = "forgotten";
    item.age = -1;
    if (!options_.output.for_people()) {
        std::ostringstream text;
        RecordPrinter(options_.output, RecordPrinter::Count::kStream, text)
            .print({{"board", board}, {"state", "forgotten"}});
        return text.str();
    }
    if (options_.services()) return {};
    return options_.output.form == Output::kName ? for_terminal(board) + "\n" : rows(item);
}

int run_watch(const ListOptions& options, Environment& environment) {
    ChangePrinter printer(options, environment.width, environment.colour);
    int status = program::kExitOk;
    const auto registry = registry_here(environment, status);
    if (!registry) return status;
    return registry->empty() ? watch_bus(options, environment, printer)
                             : watch_registry(options, environment, printer);
}

}  // namespace asip::cli
