// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/get.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/bus/registry/board_match.hpp"
#include "asip/model/json.hpp"
#include "asip/property/list.hpp"
#include "asip/property/words.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/board_values.hpp"
#include "cli/commands/get_all.hpp"
#include "cli/declaration.hpp"
#include "cli/events/leaf_values.hpp"
#include "cli/find/target.hpp"
#include "cli/text/width.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

/// Fields that an error names.
constexpr std::size_t kMaxNamed = 32;

/// BOARD/SERVICE/FIELD taken apart; FIELD may hold more slashes.
struct FieldTarget {
    Target target;
    std::string field;
};

Outcome<FieldTarget> parse_field_target(const std::string& text) {
    const auto service = text.find('/');
    const auto field = service == std::string::npos ? service : text.find('/', service + 1);
    // An empty FIELD is none: parse_target() tells what is missing.
    auto target = parse_target(field + 1 == text.size() ? text : text.substr(0, field));
    if (!target) return tl::unexpected(target.error());
    if (target->service.empty()) {
        return failure(program::kExitUsage, "which service of " + target->board + "? Write " + target->board +
                                                "/SERVICE or " + target->board + "/SERVICE/FIELD");
    }
    return FieldTarget{std::move(*target), field == std::string::npos ? "" : text.substr(field + 1)};
}

/// One value of one service, from the board.
class Getter : OnTheBus {
  public:
    Getter(const GetOptions& options, Environment& environment, FieldTarget what)
        : OnTheBus(environment),
          options_(options),
          what_(std::move(what)),
          records_(options.output, RecordPrinter::Count::kOne, environment.out) {}

    int run() {
        if (const auto status = connect()) return *status;
        if (const auto found = find(); !found) return environment_.fail_with(found.error());
        if (!property_.empty()) return show_property();
        const auto topic = environment_.topics.service_out(what_.target.board, service_.name);
        const auto reports = session_.subscribe(topic, [this](const mqtt::Message& message) {
            if (!message.retain) take(message.payload, "reported");
        });
        const auto got = get();
        return got ? program::kExitOk : environment_.fail_with(got.error());
    }

  private:
    Outcome<void> find() {
        auto board = find_living_board(source_, what_.target.board);
        if (!board) return tl::unexpected(board.error());
        auto service = find_service(*board, what_.target.service);
        if (!service) return tl::unexpected(service.error());
        board_ = std::move(*board);
        service_ = std::move(*service);
        model_ = bus::model_of(service_, environment_.models());
        if (!model_) return {};
        if (is_kept_by_agent()) return {};
        auto choice = choose_field(*model_, what_.field);
        if (!choice) return failure(program::kExitUsage, where() + ": " + choice.error());
        choice_ = *choice;
        return {};
    }

    /// Pins, and what is only set: the agent knows how they stand. What sensors measure is asked of the
    /// board.
    bool is_kept_by_agent() {
        if (!board_.description) return false;
        const auto all =
            property::properties_of(*board_.description, [this](const model::ServiceInfo& service) {
                return bus::model_of(service, environment_.models());
            });
        auto id = service_.name;
        if (!what_.field.empty()) id += "/" + what_.field;
        const auto named = property::properties_named(all, id);
        if (!options_.raw) properties_ = all;
        const bool pins = model_->name == "io" && what_.field.find('/') == std::string::npos &&
                          model_->event_named(what_.field) == nullptr;
        const bool kept = pins || std::all_of(named.begin(), named.end(),
                                              [&](std::size_t each) { return !all[each].read; });
        if (!kept || (named.empty() && !pins)) return false;
        property_ = id;
        return true;
    }

    int show_property() {
        BoardValues values(environment_, session_, board_, service_.name);
        session_.run_until([&] { return values.answered(); }, Clock::now() + environment_.timeout);
        if (!values.answered())
            return environment_.fail_with(
                session_.unanswered("the agent of " + what_.target.board + " does not answer; does it run?"));
        const auto named = property::properties_named(values.properties(), property_);
        if (named.empty())
            return environment_.fail_with(
                {program::kExitFailure, what_.target.board + " has no property " + property_ +
                                            ": a pin is one once its mode was set (asipctl pin " +
                                            what_.target.board + " 2 pullup) or a class was given to it"});
        bool known = false;
        for (const auto each : named) {
            const auto& property = values.properties()[each];
            const auto shown = values.of(each);
            known = known || shown.how != property::How::kNone;
            note_refused(environment_, what_.target.board, property);
            if (!options_.output.for_people()) {
                records_.print(value_record(what_.target.board, property, shown));
                continue;
            }
            if (property.id != property_) environment_.out << property.id << ' ';
            environment_.out << for_terminal(shown.how == property::How::kNone
                                                 ? property::unknown_text(shown.why)
                                                 : property::value_text(property, shown.value, options_.raw))
                             << '\n';
        }
        environment_.out << std::flush;
        return known ? program::kExitOk : program::kExitNoAnswer;
    }

    /// Asks the board where the model knows how, else waits for its next report.
    Outcome<void> get() {
        const auto asked = ask();
        if (printed_ || !other_fields_.empty()) return asked;
        demand();
        session_.run_until([this] { return printed_; }, Clock::now() + environment_.timeout);
        if (printed_) return {};
        if (!asked) return tl::unexpected(asked.error());
        if (!other_fields_.empty()) return without_field();
        return tl::unexpected(session_.unanswered(where() + " reported nothing within " +
                                                  std::to_string(environment_.timeout.count()) + " ms" +
                                                  advice()));
    }

    Outcome<void> ask() {
        const auto* command = model_ ? asking_command(*model_, *choice_.event) : nullptr;
        if (command == nullptr) return {};
        const std::vector<std::string> words{command->name};
        const auto request = make_command(environment_, board_, service_, words);
        if (!request) return tl::unexpected(request.error());
        const auto reply = ask_board(session_, request->to_send());
        if (!reply) return tl::unexpected(reply.error());
        if (!reply->succeeded()) return tl::unexpected(failure_of(*reply, request->line + ": "));
        take(reply->answer, "asked");
        if (!printed_ && !other_fields_.empty()) return without_field();
        return {};
    }

    /// It has values, and this is none of them.
    Outcome<void> without_field() const {
        return failure(program::kExitFailure, where() + " has no field \"" + what_.field +
                                                  "\" in its values; there are " +
                                                  for_terminal(listed(other_fields_)));
    }

    void demand() { demand_ = session_.demand(what_.target.board, service_.name); }

    std::string advice() const {
        if (!model_ || model_->command("report") == nullptr) return {};
        return "; let it report: asipctl send " + where() + " report 100";
    }

    void take(const std::string& payload, const char* how) {
        if (printed_) return;
        const auto document = model::parse_json(payload, {.max_bytes = 1U << 20U, .max_depth = 32});
        if (!document || !document->is_object()) return;
        if (!model_) {
            print({{{}, *document, {}}}, {}, how);
        } else if (document->contains(choice_.event->name)) {
            auto leaves = leaf_values(*model_, *choice_.event, (*document)[choice_.event->name]);
            other_fields_.clear();
            for (const auto& leaf : leaves)
                if (other_fields_.size() < kMaxNamed) other_fields_.push_back(leaf.path);
            say_as_properties(leaves, service_.name, choice_.event->name, properties_);
            std::erase_if(leaves, [this](const LeafValue& leaf) { return !choice_.takes(leaf.path); });
            if (!leaves.empty()) print(leaves, choice_.event->name, how);
        }
    }

    void print(const std::vector<LeafValue>& leaves, const std::string& event, const char* how) {
        printed_ = true;
        if (!options_.output.for_people()) {
            records_.print(record(leaves, event, how));
            return;
        }
        for (const auto& leaf : leaves) {
            if (leaves.size() > 1) environment_.out << leaf.path << ' ';
            auto bare = leaf;
            if (options_.raw) bare.unit.clear();
            environment_.out << for_terminal(bare.text()) << '\n';
        }
        environment_.out << std::flush;
    }

    nlohmann::json record(const std::vector<LeafValue>& leaves, const std::string& event,
                          const char* how) const {
        nlohmann::json result{{"board", what_.target.board},
                              {"service", service_.name},
                              {"time", text::iso_time(text::wall_now())},
                              {"how", how}};
        if (!event.empty()) result["event"] = event;
        if (!leaves.front().unit.empty()) result["unit"] = leaves.front().unit;
        if (leaves.size() == 1) {
            result["value"] = leaves.front().value;
            return result;
        }
        for (const auto& leaf : leaves)
            result["value"][leaf.path] = leaf.value;
        return result;
    }

    std::string where() const { return what_.target.board + "/" + service_.name; }

    const GetOptions& options_;
    FieldTarget what_;
    RecordPrinter records_;
    KnownBoard board_{};
    model::ServiceInfo service_{};
    model::ModelPtr model_{};
    FieldChoice choice_{};
    BusSession::Demand demand_{};
    std::vector<property::Property> properties_;  // of the board, for their words
    std::string property_;                        // its id, where the agent is asked
    std::vector<std::string> other_fields_;       // of the newest value
    bool printed_ = false;
};

}  // namespace

int run_get(const GetOptions& options, Environment& environment) {
    const bool pattern = options.target.find_first_of("*?") != std::string::npos;
    const bool board_alone = options.target.find('/') == std::string::npos;
    if (pattern || board_alone || options.selector) return run_get_all(options, environment);
    auto what = parse_field_target(options.target);
    if (!what) return environment.fail_with(what.error());
    return Getter(options, environment, std::move(*what)).run();
}

namespace {

Run declare_get(Declaration& verb) {
    auto options = std::make_shared<GetOptions>();
    verb.argument("BOARD[/SERVICE[/FIELD]]", options->target,
                  "What; a board alone: all its values; with * and ? as in a shell, or -l: of several "
                  "boards. FIELD is an event, a field of it, or its number",
                  Declaration::Needed::kNo);
    declare_selector(verb, options->selector);
    verb.flag("--raw", options->raw, "Without the unit");
    verb.output(options->output, {Output::kText},
                {"board", "service", "property", "name", "event", "value", "unit", "time", "how", "unknown",
                 "age", "refused", "events"});
    return [options](Environment& environment) { return run_get(*options, environment); };
}

}  // namespace

Verb get_verb() {
    return {
        "get", "Values of boards, or one value of a service, with units and ages",
        "Of a board, of pins and of what can only be set its agent says how they stand; nothing is sent to "
        "the\n"
        "board. One sensor is asked where its model knows how, else its next report counts. Exit status 4:\n"
        "nothing is known, or nothing came in time.\n"
        "Examples:\n"
        "  asipctl get uno1\n"
        "  asipctl get '*/distance' -l room=lab\n"
        "  asipctl get uno1/distance\n"
        "  asipctl get uno1/distance/0 --raw\n"
        "  asipctl get uno1/distance -o json",
        declare_get};
}

}  // namespace asip::cli
