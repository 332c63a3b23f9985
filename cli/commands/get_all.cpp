// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/get_all.hpp"

#include <algorithm>
#include <list>
#include <map>
#include <ostream>

#include "asip/bus/registry/board_match.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/model/json.hpp"
#include "asip/text/duration.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/events/leaf_values.hpp"
#include "cli/find/target.hpp"
#include "cli/text/set_text.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// Without an answer or a report within that time a service has none to show.
constexpr Duration kPatience = 2s;
constexpr std::size_t kMaxEvents = 16;

std::string pin_text(const model::Description& board, const std::string& number) {
    int pin = -1;
    if (!number.empty() && number.size() < 4 && number.find_first_not_of("0123456789") == std::string::npos)
        pin = std::stoi(number);
    const auto name = pin < 0 ? std::string() : board.labels.pin(pin);
    return "pin " + number + (name.empty() ? "" : " " + name);
}

std::string channel_text(const model::Description& board, const std::string& channel) {
    for (const auto& [pin, number] : board.pins.analog)
        if (std::to_string(number) == channel) {
            const auto name = board.labels.pin(pin);
            return "A" + channel + (name.empty() ? "" : " " + name);
        }
    return "A" + channel;
}

/// Events of the I/O service that say what its pins are, not what they do.
bool is_of_pins(const std::string& event) {
    return event == "ports" || event == "channels" || event == "modes" || event == "capabilities";
}

}  // namespace

void ServiceValues::take(const json& payload, const std::string& how, Time now) {
    if (!payload.is_object()) return;
    for (const auto& [name, value] : payload.items()) {
        if (!events_.contains(name) && events_.size() >= kMaxEvents) continue;
        auto& event = events_[name];
        if (event.value.is_object() && value.is_object())
            event.value.update(value);
        else
            event.value = value;
        event.how = how;
        event.when = now;
    }
}

std::vector<ValueRow> ServiceValues::rows(const model::Description& board, const std::string& service,
                                          const model::ServiceModel* model) const {
    std::vector<ValueRow> rows;
    const bool io = model != nullptr && model->name == "io";
    for (const auto& [name, event] : events_) {
        if (io && is_of_pins(name)) continue;
        const auto* known = model == nullptr ? nullptr : model->event_named(name);
        if (known == nullptr) {
            rows.push_back({board.board, service, name, event.value, "", model::dump_json(event.value),
                            event.how, event.when});
            continue;
        }
        for (const auto& leaf : leaf_values(*known, event.value)) {
            const bool level = io && name == "digital";
            const auto what = level                    ? pin_text(board, leaf.path)
                              : io && name == "analog" ? channel_text(board, leaf.path)
                              : leaf.path.empty()      ? name
                                                       : name + " " + leaf.path;
            const auto text = level ? (leaf.value == json(0) ? "low" : "high") : leaf.text();
            rows.push_back({board.board, service, what, leaf.value, leaf.unit, text, event.how, event.when});
        }
    }
    for (const auto& item : set_items(set_, model)) {
        if (io && item.command == "mode") continue;  // no value; asipctl pin shows it
        const auto element = item.element.empty() ? ""
                             : io                 ? " " + pin_text(board, item.element)
                                                  : " " + item.element;
        rows.push_back({board.board, service, item.command + element, item.value, "", item.value, "set", {}});
    }
    return rows;
}

namespace {

class AllValues {
  public:
    AllValues(const GetOptions& options, Target target, bus::LabelSelector labels, Environment& environment)
        : options_(options),
          target_(std::move(target)),
          labels_(std::move(labels)),
          environment_(environment),
          session_(environment),
          source_(environment, session_) {}

    int run() {
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        if (const auto found = find(); !found) return environment_.fail_with(found.error());
        for (auto& board : boards_)
            ask(board);
        const auto mark = session_.mark_retained();
        session_.run_until([&] { return mark.passed() && complete(); },
                           Clock::now() + std::min<Duration>(environment_.timeout, kPatience));
        return show();
    }

  private:
    struct Service {
        model::ServiceInfo info;
        model::ModelPtr model;
        ServiceValues values{};
        std::list<BusSession::Request> asked{};
        std::size_t open = 0;
        /// Whether something is to be expected of it.
        bool reports() const { return model == nullptr || !model->events.empty(); }
    };
    struct Board {
        KnownBoard known;
        std::list<Service> services{};
        BusSession::Subscription reports{}, set{};
        BusSession::Demand demand{};
    };

    Outcome<void> find() {
        auto boards = choose_boards(source_, target_, labels_);
        if (!boards) return tl::unexpected(boards.error());
        for (auto& board : *boards) {
            if (board.item.state != "online" || !board.description) {
                environment_.note(board.item.board + ": no values: it is " + board.item.state);
                continue;
            }
            auto& made = boards_.emplace_back(Board{std::move(board)});
            for (const auto& service : made.known.description->services)
                if (target_.matches(made.known.item.board, service.name))
                    made.services.push_back({service, bus::model_of(service, environment_.models())});
        }
        if (boards_.empty()) return failure(program::kExitNoAnswer, "none of these boards is there");
        return {};
    }

    Service* service(Board& board, std::string_view name) {
        const auto found = std::find_if(board.services.begin(), board.services.end(),
                                        [&](const Service& each) { return each.info.name == name; });
        return found == board.services.end() ? nullptr : &*found;
    }

    void ask(Board& board) {
        const auto& name = board.known.item.board;
        const auto take = [this, &board](const mqtt::Message& message, bool set) {
            const auto topic = environment_.topics.parse(message.topic);
            auto* of = topic ? service(board, topic->service) : nullptr;
            const auto document = model::parse_json(message.payload);
            if (of == nullptr || !document) return;
            if (set)
                of->values.set(*document);
            else if (!message.retain)
                of->values.take(*document, "reported", Clock::now());
        };
        board.reports = session_.subscribe(environment_.topics.service_out(name, "+"),
                                           [take](const mqtt::Message& message) { take(message, false); });
        board.set = session_.subscribe(environment_.topics.service_set(name, "+"),
                                       [take](const mqtt::Message& message) { take(message, true); });
        board.demand = session_.demand(name, "*");
        for (auto& each : board.services)
            ask(board, each);
    }

    // What the model knows how to ask for. Nothing is ever set to learn a value.
    void ask(Board& board, Service& each) {
        if (!each.model || each.model->name == "io") return;
        for (const auto& event : each.model->events) {
            const auto* command = asking_command(*each.model, event);
            if (command == nullptr) continue;
            const std::vector<std::string> words{command->name};
            const auto request = make_command(environment_, board.known, each.info, words);
            if (!request) continue;
            ++each.open;
            each.asked.push_back(
                session_.command(request->topic, request->payload,
                                 [&each](const mqtt::Message& message) { answered(each, message); }));
        }
    }

    static void answered(Service& service, const mqtt::Message& message) {
        if (service.open > 0) --service.open;
        const auto reply = bus::parse_reply(message.payload);
        if (!reply || !reply->succeeded() || reply->answer.empty()) return;
        if (const auto document = model::parse_json(reply->answer))
            service.values.take(*document, "asked", Clock::now());
    }

    bool complete() const {
        return std::all_of(boards_.begin(), boards_.end(), [](const Board& board) {
            return std::all_of(board.services.begin(), board.services.end(), [](const Service& each) {
                return each.open == 0 && (!each.reports() || !each.values.empty());
            });
        });
    }

    int show() {
        const auto now = Clock::now();
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"SERVICE"}, {"WHAT"}, {"VALUE", false, 10}, {"AGE", true}});
        bool any = false;
        for (const auto& board : boards_)
            for (const auto& each : board.services)
                for (const auto& row :
                     each.values.rows(*board.known.description, each.info.name, each.model.get())) {
                    any = true;
                    const std::chrono::duration<double> age = row.when ? now - *row.when : Duration{};
                    if (options_.output.for_people()) {
                        table.add(
                            {row.board + "/" + row.service, row.what,
                             options_.raw && row.value.is_number() ? model::dump_json(row.value) : row.text,
                             row.when ? text::duration_text(age) : row.how});
                        continue;
                    }
                    json record{{"board", row.board},
                                {"service", row.service},
                                {"what", row.what},
                                {"value", row.value},
                                {"how", row.how}};
                    if (!row.unit.empty()) record["unit"] = row.unit;
                    if (row.when) record["age"] = age.count();
                    records.print(record);
                }
        records.finish();
        if (!table.empty())
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        if (any) return program::kExitOk;
        return environment_.fail_with(session_.unanswered(
            "no service reported a value; let one report: asipctl send BOARD/SERVICE report 100"));
    }

    const GetOptions& options_;
    const Target target_;
    const bus::LabelSelector labels_;
    Environment& environment_;
    BusSession session_;
    BoardSource source_;
    std::list<Board> boards_;
};

}  // namespace

int run_get_all(const GetOptions& options, Environment& environment) {
    auto labels = parse_selector(options.selector);
    if (!labels) return environment.fail_with(labels.error());
    auto target = parse_target(options.target.empty() ? "*" : options.target, true);
    if (!target) return environment.fail_with(target.error());
    if (options.watch)
        return environment.fail_with(
            {program::kExitUsage,
             "--watch goes with one service; of a whole board: asipctl subscribe " + target->board});
    return AllValues(options, std::move(*target), std::move(*labels), environment).run();
}

}  // namespace asip::cli
