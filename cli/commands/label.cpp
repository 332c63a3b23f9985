// SPDX-License-Identifier: Apache-2.0
#include <list>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "asip/bus/request/agent_requests.hpp"
#include "asip/model/json.hpp"
#include "asip/text/json_reader.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/side_by_side.hpp"
#include "cli/commands/label_words.hpp"
#include "cli/commands/pin.hpp"
#include "cli/environment.hpp"
#include "cli/find/target.hpp"
#include "cli/flash/lent_port.hpp"
#include "cli/output.hpp"
#include "cli/text/table.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

struct LabelOptions {
    std::string target;
    std::vector<std::string> words;  ///< as model::add_assignment() takes them
    SelectorText selector{};
    OutputOptions output{};
};

/// An agent announces at most once a second what changed.
constexpr std::chrono::milliseconds kAnnounceTime{2500};

model::Labels labels_of(const nlohmann::json& object) {
    std::string fault;
    text::JsonReader reader(object, "", fault);
    return model::read_labels(reader);
}

/// One `asipctl label`: shows labels, or asks the agents of the boards to change them.
class Labeller : OnTheBus {
  public:
    Labeller(const LabelOptions& options, Target target, bus::LabelSelector selector,
             model::LabelChange change, PinNames pin_names, Environment& environment)
        : OnTheBus(environment),
          options_(options),
          target_(std::move(target)),
          selector_(std::move(selector)),
          change_(std::move(change)),
          pin_names_(std::move(pin_names)) {}

    int run() {
        if (const auto status = connect()) return *status;
        auto boards = find();
        if (!boards) return environment_.fail_with(boards.error());
        if (const auto named = name_pins(*boards); !named) return environment_.fail_with(named.error());
        return change_.empty() ? show(*boards) : change(*boards);
    }

  private:
    struct Asked {
        std::string board;
        std::optional<bus::BoardItem> lost{};
        std::optional<bus::Reply> reply{};
        std::string set_aside{};
        std::string fault{};
        model::Labels now{};
        std::optional<model::Labels> announced{};
        BusSession::Subscription descriptions{};
        BusSession::Call call{};
    };

    bool one_board() const { return !target_.is_pattern() && !options_.selector; }

    static std::string why_none(const KnownBoard& board) {
        return board.description_fault.empty()
                   ? "is known by its names only: it has no agent that keeps labels"
                   : board.why_no_description();
    }

    Outcome<std::vector<KnownBoard>> find() {
        if (!one_board()) return choose_boards(source_, target_, selector_);
        auto board = change_.empty() && pin_names_.empty() ? source_.board(target_.board)
                                                           : find_board_with_agent(source_, target_.board);
        if (!board) return tl::unexpected(board.error());
        if (!board->description)
            return failure(program::kExitFailure, target_.board + " " + why_none(*board));
        if (!target_.service.empty())
            if (const auto service = find_service(*board, target_.service); !service)
                return tl::unexpected(service.error());
        return std::vector<KnownBoard>{std::move(*board)};
    }

    /// Each board has pins and names of pins of its own.
    Outcome<void> name_pins(const std::vector<KnownBoard>& boards) {
        for (const auto& [written, name] : pin_names_) {
            if (!one_board())
                return failure(program::kExitUsage,
                               "pin." + written + ": of several boards write the number, such as pin.13");
            const auto pin = find_pin(written, *boards.front().description);
            if (!pin) return tl::unexpected(pin.error());
            if (name)
                if (const auto why = model::explain_friendly_name(*name); !why.empty())
                    return failure(program::kExitUsage, "the name of a pin " + why);
            change_.pins[*pin] = name;
        }
        return {};
    }

    model::Labels shown(model::Labels labels) const {
        if (target_.service.empty()) return labels;
        std::erase_if(labels.services,
                      [this](const auto& one) { return !target_.matches(target_.board, one.first); });
        labels.labels.clear();
        labels.pins.clear();
        return labels;
    }

    int show(const std::vector<KnownBoard>& boards) {
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"TARGET"}, {"KEY"}, {"VALUE", false, 10}});
        bool any = false;
        int status = program::kExitOk;
        for (const auto& board : boards) {
            if (!board.description) continue;
            const auto labels = shown(board.description->labels);
            const auto& fault = board.description->labels_fault;
            if (!fault.empty()) {
                note_fault(board.item.board, fault);
                status = program::kExitFailure;
            }
            any = any || !labels.empty() || !fault.empty();
            if (options_.output.for_people())
                add_rows(table, board.item.board, labels);
            else
                records.print(record(board.item.board, labels, fault));
        }
        records.finish();
        if (!table.empty())
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        if (!any) environment_.note("no labels; set one: asipctl label BOARD room=lab");
        return status;
    }

    void note_fault(const std::string& board, const std::string& fault) const {
        environment_.note(board + ": labels that its agent kept cannot be read: " + for_terminal(fault));
    }

    static nlohmann::json record(const std::string& board, const model::Labels& labels,
                                 const std::string& fault) {
        nlohmann::json object{{"board", board}, {"labels", nlohmann::json::object()}};
        model::put_labels(object, labels);
        object.erase("pin_modes");  // what commands did, and no words of people
        if (!fault.empty()) object["labels_fault"] = fault;
        return object;
    }

    int change(const std::vector<KnownBoard>& boards) {
        for (const auto& board : boards) {
            if (!board.description || board.item.state == "offline") {
                asked_.emplace_back(Asked{board.item.board}).reply = bus::Reply::refused(
                    std::string(bus::kRefusedBoardNotThere),
                    board.description ? "it is offline: its agent has ended" : "it " + why_none(board));
                continue;
            }
            auto& asked = asked_.emplace_back(Asked{board.item.board});
            if (board.item.state == "lost") asked.lost = board.item;
        }
        std::list<Asked*> there;
        for (auto& asked : asked_)
            if (!asked.reply) there.push_back(&asked);
        ask_side_by_side(
            session_, std::move(there), kAskedAtOnce, [this](Asked& one) { return ask(one); },
            [](const Asked& one) { return one.reply.has_value(); });
        // The next program that asks for boards finds them by their new labels.
        session_.run_until(
            [this] {
                return std::all_of(asked_.begin(), asked_.end(), [](const Asked& one) {
                    return !one.reply || !one.reply->succeeded() || one.announced == one.now;
                });
            },
            Clock::now() + kAnnounceTime);
        return report();
    }

    /// A board that is lost may have an agent that is there, which keeps labels (its cable was pulled out);
    /// that answers soon or not at all.
    Time ask(Asked& asked) {
        asked.descriptions = session_.subscribe(
            environment_.topics.description(asked.board), [&asked](const mqtt::Message& message) {
                if (auto description = model::parse_description(message.payload))
                    asked.announced = std::move(description->labels);
            });
        asked.call = session_.command(
            {.topic = environment_.topics.board_in(asked.board),
             .payload = bus::encode(change_, who_asks(environment_))},
            [&asked](const bus::Reply& reply) {
                const bool is_kept = !reply.succeeded() || reply.proof == bus::kProofKept;
                asked.reply =
                    is_kept
                        ? reply
                        : bus::Reply::refused(
                              std::string(bus::kRefusedNotKept),
                              "the program that answers for this board keeps no labels: it is no asip-agent");
                const auto answer = model::parse_json(reply.answer).value_or(nlohmann::json::object());
                asked.now = labels_of(answer);
                asked.set_aside = value_at(answer, "set_aside");
                asked.fault = value_at(answer, "labels_fault");
            });
        return asked.lost ? Clock::now() + std::min(environment_.timeout, kProbeWindow) : Time::max();
    }

    int report() {
        int status = program::kExitOk;
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"TARGET"}, {"KEY"}, {"VALUE", false, 10}});
        for (const auto& asked : asked_) {
            const auto reply = reply_of(asked);
            const auto labels = shown(asked.now);
            if (!reply.succeeded()) {
                environment_.note(note_of(asked.board, reply));
                if (status == program::kExitOk) status = exit_status(reply);
            }
            if (!asked.set_aside.empty())
                environment_.note(asked.board +
                                  ": labels that its agent kept could not be read; the file is now " +
                                  for_terminal(asked.set_aside));
            if (options_.output.for_people()) {
                add_rows(table, asked.board, labels);
                continue;
            }
            auto object = record(asked.board, labels, asked.fault);
            if (!asked.set_aside.empty()) object["set_aside"] = asked.set_aside;
            object["status"] = bus::to_string(reply.status);
            if (!reply.reason.empty()) object["reason"] = reply.reason;
            if (!reply.error.empty()) object["error"] = reply.error;
            records.print(object);
        }
        records.finish();
        if (!table.empty())
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        return status;
    }

    static bus::Reply reply_of(const Asked& asked) {
        if (asked.reply) return *asked.reply;
        return asked.lost ? refused_as_lost(*asked.lost, "nothing was kept") : not_waited_for();
    }

    const LabelOptions& options_;
    const Target target_;
    const bus::LabelSelector selector_;
    model::LabelChange change_;
    const PinNames pin_names_;
    std::list<Asked> asked_;
};

/// `asipctl label -l room=lab shelf=3` and `asipctl label` name no board.
void find_target(LabelOptions& options) {
    const auto& first = options.target;
    const bool change = first.find('=') != std::string::npos || (options.selector && first.ends_with('-'));
    if (change && options.selector)
        options.words.insert(options.words.begin(), std::exchange(options.target, ""));
    if (options.target.empty()) options.target = "*";
}

/// `asipctl label`: shows labels and friendly names, or asks the agents of the boards to change them.
int run_label(LabelOptions options, Environment& environment) {
    const auto selector = parse_selector(options.selector);
    if (!selector) return environment.fail_with(selector.error());
    find_target(options);
    if (options.target.find('=') != std::string::npos)
        return environment.fail_with({program::kExitUsage, "which board? Write asipctl label BOARD " +
                                                               options.target +
                                                               ", or choose boards by -l SELECTOR"});
    const auto property = property_in(options.target);
    const auto target = parse_target(options.target, true);
    if (!target) return environment.fail_with(target.error());
    if (!options.words.empty() && target->service.find_first_of("*?") != std::string::npos)
        return environment.fail_with({program::kExitUsage, "'" + target->service + "': name one service"});
    model::LabelChange change;
    auto pin_names = target->service.empty() ? take_pin_names(options.words) : PinNames();
    if (!property.empty())
        if (const auto added = add_meanings(change, property, std::exchange(options.words, {})); !added)
            return environment.fail_with({program::kExitUsage, added.error()});
    for (const auto& word : options.words)
        if (const auto added = model::add_assignment(change, word, target->service); !added)
            return environment.fail_with({program::kExitUsage, added.error()});
    return Labeller(options, *target, *selector, std::move(change), std::move(pin_names), environment).run();
}

Run declare_label(Declaration& verb) {
    auto options = std::make_shared<LabelOptions>();
    verb.argument("BOARD[/SERVICE]", options->target,
                  "Which, or a property (uno1/io/2); with * and ? as in a shell. Without it, or with -l "
                  "alone: every board",
                  Declaration::Needed::kNo);
    verb.arguments(
        "LABEL", options->words,
        "What to set: KEY=VALUE; name=NAME of a board or service, pin.13=NAME, pin.A0=NAME; of a property "
        "what it is: class=door inverted=yes. KEY- removes it. Without any: what there is",
        Declaration::Needed::kNo);
    declare_selector(verb, options->selector);
    verb.output(options->output, {Output::kTable},
                {"board", "labels", "names", "labels_fault", "set_aside", "status", "error", "reason"});
    return [options](Environment& environment) { return run_label(*options, environment); };
}

}  // namespace

Verb label_verb() {
    return {"label", "Labels of boards, and friendly names of their services and pins",
            "They are kept by the board's agent, on its disk, and stand in the board's description. Boards "
            "are chosen by\n"
            "them with -l in list, subscribe, send and label: KEY=VALUE, KEY!=VALUE, KEY (it has one), !KEY; "
            "a comma means and.\n"
            "Exit status: 0 all kept, 1 refused, 4 no answer.\n"
            "Examples:\n"
            "  asipctl label uno1 room=lab floor=2\n"
            "  asipctl label uno1 floor-\n"
            "  asipctl label uno1/io/2 class=door inverted=yes\n"
            "  asipctl label uno1 name=\"Ann's robot\"\n"
            "  asipctl label uno1/servo name=\"left arm\"\n"
            "  asipctl label uno1 pin.13=\"status lamp\" pin.A0=light\n"
            "  asipctl label 'uno*' room=lab\n"
            "  asipctl label -l room=lab,!shelf shelf=3\n"
            "  asipctl label uno1\n"
            "  asipctl label --format '{board} {labels.room}'",
            declare_label};
}

}  // namespace asip::cli
