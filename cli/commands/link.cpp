// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/links/shown.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/property/documents.hpp"
#include "asip/property/words.hpp"
#include "asip/text/nearest.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/retained.hpp"
#include "cli/declaration.hpp"
#include "cli/text/table.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using links::Link;
using links::ShownLink;
using nlohmann::json;

constexpr std::chrono::milliseconds kShownWithin{2500};
// A command may have made a pin the source a moment ago: its agent says so after half a second at most.
constexpr std::chrono::milliseconds kToldWithin{1000};
constexpr std::string_view kNotHeard = " is not heard";

struct LinkOptions {
    std::string what;
    std::vector<std::string> words;
    bool toggle = false, inverted = false, safe = false;
    std::string name, on, send, line, between;
    std::optional<std::string> above, below, back, value, otherwise;
    std::optional<std::chrono::milliseconds> after, lasts;
    OutputOptions output;
};

tl::unexpected<Failure> usage(std::string text) {
    return failure(program::kExitUsage, std::move(text));
}

std::pair<std::string, std::string> split(const std::string& text) {
    const auto slash = text.find('/');
    return {text.substr(0, slash), slash == std::string::npos ? "" : text.substr(slash + 1)};
}

json value_of(const std::string& word) {
    if (word == "on" || word == "off") return word == "on";
    const auto value = model::parse_json(word);
    return value && value->is_primitive() ? *value : json(word);
}

/// "0..1023=0..180".
json line_of(const std::string& text) {
    auto list = "[" + text + "]";
    for (const auto* mark : {"..", "=", ".."})
        if (const auto at = list.find(mark); at != std::string::npos)
            list.replace(at, std::string_view(mark).size(), ",");
    return model::parse_json(list).value_or(json(text));
}

/// How the source moves the target, as the agent reads it. Fails where options do not go together.
Outcome<json> rule_of(const LinkOptions& options) {
    json rule = json::object();
    std::string given;
    const auto when = [&](bool is, const char* option, const std::string& word) -> Outcome<void> {
        if (!is) return {};
        if (!given.empty()) return usage(given + " and " + option + " do not go together");
        given = option;
        rule["when"] = word;
        return {};
    };
    for (const auto& done :
         {when(options.toggle, "--toggle", "toggles"), when(options.inverted, "--inverted", "inverted"),
          when(options.above.has_value(), "--above", "above"),
          when(options.below.has_value(), "--below", "below"), when(!options.on.empty(), "--on", options.on)})
        if (!done) return tl::unexpected(done.error());
    for (const auto& [key, word] : {std::pair("level", &options.above), std::pair("level", &options.below),
                                    std::pair("back", &options.back), std::pair("value", &options.value),
                                    std::pair("else", &options.otherwise)})
        if (*word) rule[key] = value_of(**word);
    if (!options.send.empty()) rule["command"] = model::parse_json(options.send).value_or(json(options.send));
    if (!options.line.empty()) rule["line"] = line_of(options.line);
    if (!options.between.empty()) rule["between"] = options.between;
    for (const auto& [key, time] : {std::pair("after", options.after), std::pair("for", options.lasts)})
        if (time) rule[key] = std::chrono::duration<double>(*time).count();
    if (options.safe) rule["safe"] = true;
    return rule;
}

class Linker : OnTheBus {
  public:
    Linker(const LinkOptions& options, Environment& environment) : OnTheBus(environment), options_(options) {}

    Outcome<int> run() {
        if (const auto connected = session_.connect(); !connected) return tl::unexpected(connected.error());
        const auto retained = read_retained(
            environment_, session_, {environment_.topics.links("+"), environment_.topics.properties("+")});
        if (!retained) return tl::unexpected(retained.error());
        for (const auto& message : *retained) {
            const auto topic = environment_.topics.parse(message.topic);
            if (!topic) continue;
            for (auto& each : links::read_shown(topic->board, message.payload))
                links_.push_back(std::move(each));
            if (auto list = property::parse_list(message.payload))
                properties_[std::string(topic->board)] = std::move(list->properties);
        }
        const auto& what = options_.what;
        if (what == "list") return list();
        if (what == "remove" || what == "enable" || what == "disable") return change();
        return make();
    }

  private:
    int list() {
        RecordPrinter records(options_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"LINK"}, {"RULE", false, 20}, {"STATE"}, {"LAST", false, 20}});
        for (const auto& each : links_) {
            if (!options_.words.empty() && each.board != options_.words.front()) continue;
            if (options_.output.for_people())
                table.add({each.id(), value_at(each.object, "rule"), value_at(each.object, "state"),
                           value_at(each.object, "last")});
            else
                records.print(each.object);
        }
        records.finish();
        if (!table.empty())
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        if (links_.empty())
            environment_.note("no links; make one: asipctl link desk/io/2 lamp/io/13 --toggle");
        return program::kExitOk;
    }

    Outcome<int> change() {
        if (options_.words.size() != 1)
            return usage("link " + options_.what + " needs one NAME, or BOARD/NAME");
        const auto& wanted = options_.words.front();
        std::vector<const ShownLink*> found;
        std::vector<std::string> names;
        for (const auto& each : links_) {
            names.push_back(wanted.find('/') == std::string::npos ? each.link.name : each.id());
            if (names.back() == wanted) found.push_back(&each);
        }
        if (found.empty())
            return failure(program::kExitFailure,
                           "there is no link " + wanted + text::did_you_mean(wanted, names));
        if (found.size() > 1)
            return usage("several boards have a link " + wanted + ": write " + found.front()->id());
        const auto& link = *found.front();
        if (const auto done = ask(link.board, link.link.user, {{options_.what, link.link.name}}); !done)
            return tl::unexpected(done.error());
        environment_.say(link.id() + (options_.what == "remove" ? " removed" : " " + options_.what + "d"));
        return program::kExitOk;
    }

    /// The id of one property that a person means.
    Outcome<std::string> id_of(const std::string& board, const std::string& id) const {
        const auto found = properties_.find(board);
        if (found == properties_.end()) return id;
        const auto meant = property::properties_named(found->second, id);
        if (meant.size() == 1) return found->second[meant.front()].id;
        if (meant.empty()) return id;  // the fault names the nearest
        return usage(board + "/" + id + " is several: " + listed(meant, ", ", [&](auto each) {
                         return found->second[each].id;
                     }));
    }

    Outcome<Link> read(const std::string& board) const {
        auto rule = rule_of(options_);
        if (!rule) return tl::unexpected(rule.error());
        const auto [source, id] = split(options_.what);
        const auto target = split(options_.words.front()).second;
        for (const auto& [each, text] :
             {std::pair(id, options_.what), std::pair(target, options_.words.front())})
            if (each.empty()) return usage(text + " is no property: write BOARD/PROPERTY, such as desk/io/2");
        const auto from = id_of(source, id);
        const auto to = rule->contains("command") ? Outcome<std::string>(target) : id_of(board, target);
        if (!from || !to) return tl::unexpected((from ? to : from).error());
        (*rule)["from"] = source + "/" + *from;
        (*rule)["to"] = *to;
        (*rule)["name"] =
            options_.name.empty() ? model::suggest_name(source + "-" + *from + "-" + *to) : options_.name;
        auto link = links::read_link(*rule);
        if (!link) return usage(link.error());
        return std::move(*link);
    }

    std::string fault_of_source(const Link& link) const {
        const auto found = properties_.find(link.board);
        return found == properties_.end() ? std::string() : links::source_fault(link, found->second);
    }

    /// What the target's agent cannot know yet, or never.
    Outcome<void> check(const Link& link, const std::string& board) {
        for (const auto& name : {link.board, board})
            if (const auto found = source_.board(name); !found) return tl::unexpected(found.error());
        if (const auto fault = fault_of_source(link); !fault.empty())
            return failure(program::kExitFailure, fault);
        std::vector<links::Ends> ends;
        for (const auto& each : links_)
            if (each.board != board || each.link.name != link.name)
                ends.emplace_back(each.link.board + "/" + each.link.source,
                                  each.board + "/" + each.link.target);
        const auto circle = links::circle(ends, {link.board + "/" + link.source, board + "/" + link.target});
        return circle.empty() ? Outcome<void>()
                              : failure(program::kExitFailure, "that would be a circle: " + circle);
    }

    Outcome<int> make() {
        if (options_.words.size() != 1) return usage("write asipctl link BOARD/PROPERTY BOARD/PROPERTY");
        const auto board = split(options_.words.front()).first;
        auto link = read(board);
        if (link && !fault_of_source(*link).empty()) {
            const auto told = session_.subscribe(
                environment_.topics.properties(link->board), [&](const mqtt::Message& message) {
                    if (auto list = property::parse_list(message.payload))
                        properties_[link->board] = std::move(list->properties);
                });
            session_.run_until([&] { return fault_of_source(*link).empty(); }, Clock::now() + kToldWithin);
            link = read(board);
        }
        if (!link) return tl::unexpected(link.error());
        if (const auto good = check(*link, board); !good) return tl::unexpected(good.error());
        std::optional<std::string> fault;
        const auto shown =
            session_.subscribe(environment_.topics.links(board), [&](const mqtt::Message& message) {
                for (const auto& each : links::read_shown(board, message.payload))
                    if (each.link.name == link->name) fault = value_at(each.object, "fault");
            });
        if (const auto done = ask(board, environment_.mqtt.user, {{"set", links::to_json(*link)}}); !done)
            return tl::unexpected(done.error());
        environment_.say(board + "/" + link->name + ": " + links::in_words(*link));
        session_.run_until([&] { return fault && fault->empty(); }, Clock::now() + kShownWithin);
        if (!fault || fault->empty()) return program::kExitOk;
        const bool secured = !environment_.mqtt.user.empty() && fault->ends_with(kNotHeard);
        environment_.note(*fault + (secured ? "; its agent must be allowed to read it: asipctl secure link " +
                                                  board + " " + link->board
                                            : ""));
        return program::kExitOk;
    }

    Outcome<void> ask(const std::string& board, const std::string& user, const json& request) {
        const auto who = bus::user_level(user) + "/" + environment_.mqtt.client_id;
        const auto reply = ask_board(
            session_, {.topic = environment_.topics.link(board, who), .payload = model::dump_json(request)});
        if (!reply) return tl::unexpected(reply.error());
        if (!reply->succeeded()) return tl::unexpected(failure_of(*reply, board + ": "));
        return {};
    }

    const LinkOptions& options_;
    std::vector<ShownLink> links_;
    std::map<std::string, std::vector<property::Property>> properties_;
};

Run declare_link(Declaration& verb) {
    auto options = std::make_shared<LinkOptions>();
    verb.argument("BOARD/PROPERTY|list|remove|enable|disable|...", options->what,
                  "The source, or what to do");
    verb.arguments("BOARD/PROPERTY", options->words,
                   "The target; list: a board; remove, enable, disable: the name of a link",
                   Declaration::Needed::kNo);
    verb.flag("--toggle", options->toggle, "Each press switches the target");
    verb.flag("--inverted", options->inverted, "On while the source is off");
    verb.option("--above", "LEVEL", options->above, "On while the source is above it");
    verb.option("--below", "LEVEL", options->below, "On while the source is below it");
    verb.option("--back", "LEVEL", options->back, "Where above or below ends; default: there");
    verb.option("--on", "press|release|hold|double", options->on, "At each of these");
    verb.option("--value", "VALUE", options->value,
                "What the target gets; default: on, or the source's value");
    verb.option("--else", "VALUE", options->otherwise, "What it gets in the other case; default: off");
    verb.option("--line", "FROM..TO=FROM..TO", options->line, "A number becomes another: 0..1023=0..180");
    verb.option("--send", "JSON", options->send,
                "A command for the target, then BOARD/SERVICE: {\"play\":[440,200]}");
    verb.option("--after", options->after, "Only when it was so for this time");
    verb.option("--for", options->lasts, "Back again after this time");
    verb.option("--between", "HH:MM-HH:MM", options->between, "Only between two times of day");
    verb.flag("--safe", options->safe, "Off when the source is not there for a second; motors always are");
    verb.option("--name", "NAME", options->name, "Of the link; default: made of its ends");
    verb.output(options->output, {Output::kTable},
                {"board", "name", "from", "when", "to", "rule", "state", "last", "at", "user", "fault"});
    return [options](Environment& environment) {
        const auto status = Linker(*options, environment).run();
        return status ? *status : environment.fail_with(status.error());
    };
}

}  // namespace

Verb link_verb() {
    return {"link", "Let one board switch another, without a program",
            "The agent of the target's board keeps and executes a link, while all other programs are off.\n"
            "Whoever sets the target by another way wins, until the source changes.\n"
            "Exit status: 0 done, 1 refused, 4 no answer.\n"
            "Examples:\n"
            "  asipctl link desk/io/2 lamp/io/13 --toggle\n"
            "  asipctl link desk/temperature fan/io/5 --above 30 --back 28\n"
            "  asipctl link hall/motion/0/motion hall/io/6 --for 2m --between 22:00-06:00\n"
            "  asipctl link list\n"
            "  asipctl link remove desk-io-2-io-13",
            declare_link};
}

}  // namespace asip::cli
