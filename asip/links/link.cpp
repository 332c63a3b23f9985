// SPDX-License-Identifier: Apache-2.0
#include "asip/links/link.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/property/contact.hpp"
#include "asip/property/value.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::links {
namespace {

using nlohmann::json;
using property::Kind;
using property::Property;

constexpr std::pair<When, std::string_view> kWhen[] = {
    {When::kFollows, "follows"}, {When::kInverted, "inverted"}, {When::kAbove, "above"},
    {When::kBelow, "below"},     {When::kToggles, "toggles"},   {When::kPress, "press"},
    {When::kRelease, "release"}, {When::kHold, "hold"},         {When::kDouble, "double"}};
constexpr double kMost = 1e9;
constexpr double kLongest = 7 * 24 * 3600;
constexpr std::size_t kMaxIdBytes = 160;
constexpr int kMinutes = 24 * 60;

std::string two_digits(int number) {
    return (number < 10 ? "0" : "") + std::to_string(number);
}

std::string time_text(int minutes) {
    return two_digits(minutes / 60) + ":" + two_digits(minutes % 60);
}

std::optional<int> minutes_of(std::string_view text) {
    const auto digit = [&](std::size_t at) {
        return text[at] >= '0' && text[at] <= '9' ? text[at] - '0' : 99;
    };
    if (text.size() != 5 || text[2] != ':') return std::nullopt;
    const int hours = digit(0) * 10 + digit(1), minutes = digit(3) * 10 + digit(4);
    if (hours > 23 || minutes > 59) return std::nullopt;
    return hours * 60 + minutes;
}

double seconds(Duration time) {
    return std::chrono::duration<double>(time).count();
}

Duration duration(double seconds) {
    return std::chrono::round<Duration>(std::chrono::duration<double>(seconds));
}

/// A value that a target can get: no lists.
void read_value(text::JsonReader& reader, const char* key, json& value) {
    const auto* found = reader.find(key);
    if (found == nullptr) return;
    if (found->is_structured()) return reader.fault(key, "must be true or false, a number or a text");
    if (found->is_string() && found->get_ref<const std::string&>().size() > kMaxIdBytes)
        return reader.fault(key, "is too long");
    value = *found;
}

void read_line(text::JsonReader& reader, Link& link) {
    const auto* found = reader.find("line");
    if (found == nullptr) return;
    const bool numbers = found->is_array() && found->size() == 4 &&
                         std::all_of(found->begin(), found->end(), [](const json& each) {
                             return each.is_number() && std::abs(each.get<double>()) <= kMost;
                         });
    if (!numbers) return reader.fault("line", "must be four numbers: from, to, and what they become");
    link.line = found->get<std::array<double, 4>>();
    if ((*link.line)[0] == (*link.line)[1]) reader.fault("line", "begins where it ends");
}

void read_condition(text::JsonReader& reader, Link& link) {
    const auto word = reader.text("when", "follows");
    const auto when = when_of(word);
    if (!when)
        return reader.fault("when", "\"" + text::printable(word, 32) + "\" is no condition" +
                                        text::did_you_mean(word, when_words()));
    link.when = *when;
    const bool level = *when == When::kAbove || *when == When::kBelow;
    for (const auto& [key, number] : {std::pair("level", &link.level), std::pair("back", &link.back)}) {
        if (!reader.has(key)) continue;
        *number = reader.number(key, 0, -kMost, kMost);
        if (!level) reader.fault(key, "goes with above and below");
    }
    if (level && !link.level) reader.fault("level", "is missing");
    if (link.level && link.back &&
        (*when == When::kAbove ? *link.back > *link.level : *link.back < *link.level))
        reader.fault("back",
                     *when == When::kAbove ? "must not be above the level" : "must not be below the level");
}

/// What is subscribed to is named after it.
bool could_be_id(const std::string& id) {
    return model::valid_name(property::service_of(id)) && text::printable(id, kMaxIdBytes) == id;
}

void check(text::JsonReader& reader, const Link& link) {
    if (!model::valid_name(link.name)) reader.fault("name", model::explain_board_name(link.name));
    if (!model::valid_board_name(link.board))
        reader.fault("from", "must be BOARD/PROPERTY, such as desk/io/2");
    if (!could_be_id(link.source)) reader.fault("from", "must be BOARD/PROPERTY, such as desk/io/2");
    if (!could_be_id(link.target)) reader.fault("to", "must be a property, such as io/13");
    if (link.line && link.when != When::kFollows) reader.fault("line", "goes with follows");
    if (link.line && !(link.value.is_null() && link.otherwise.is_null()))
        reader.fault("line", "makes the value itself");
    if (link.when == When::kToggles && link.lasts > Duration{})
        reader.fault("for", "does not go with toggles");
    const bool level = !is_event(link.when);
    if (!link.command.is_null() && (link.lasts > Duration{} || link.when == When::kToggles || link.line ||
                                    !link.value.is_null() || !link.otherwise.is_null()))
        reader.fault("command", "is sent as it is, once: it goes with after and between alone");
    if (link.safe && !level) reader.fault("safe", "does not go with what happens once");
}

std::string not_there(std::string_view id, const std::vector<Property>& properties, bool to_set) {
    std::vector<std::string> ids;
    for (const auto& each : properties)
        if (!to_set || each.settable()) ids.push_back(each.id);
    return "there is no property " + text::printable(id, 64) + text::did_you_mean(id, ids);
}

bool two_states(const Property& property) {
    return property.kind == Kind::kSwitch || property.kind == Kind::kBinarySensor ||
           property.kind == Kind::kLight;
}

bool is_number(const Property& property) {
    return property.kind == Kind::kNumber || property.kind == Kind::kLight ||
           (property.kind == Kind::kSensor && property.choices.empty() && property.max_length == 0);
}

}  // namespace

const Property* find(const std::vector<Property>& properties, std::string_view id) {
    const auto found =
        std::find_if(properties.begin(), properties.end(), [id](const auto& each) { return each.id == id; });
    return found == properties.end() ? nullptr : &*found;
}

std::string_view to_text(When when) {
    for (const auto& [each, word] : kWhen)
        if (each == when) return word;
    return {};
}

std::vector<std::string_view> when_words() {
    std::vector<std::string_view> words;
    for (const auto& each : kWhen)
        words.push_back(each.second);
    return words;
}

std::optional<When> when_of(std::string_view word) {
    for (const auto& [when, each] : kWhen)
        if (each == word) return when;
    return std::nullopt;
}

Expected<std::pair<int, int>> parse_between(std::string_view text) {
    const auto from = text.size() == 11 && text[5] == '-' ? minutes_of(text.substr(0, 5)) : std::nullopt;
    const auto to = from ? minutes_of(text.substr(6)) : std::nullopt;
    if (!to || *from == *to) return fail("must be two times of day, such as 22:00-06:00");
    return std::pair(*from, *to);
}

json to_json(const Link& link) {
    json object{{"name", link.name},
                {"from", link.board + "/" + link.source},
                {"when", to_text(link.when)},
                {"to", link.target}};
    if (link.level) object["level"] = property::json_number(*link.level);
    if (link.back) object["back"] = property::json_number(*link.back);
    if (!link.command.is_null()) object["command"] = link.command;
    if (!link.value.is_null()) object["value"] = link.value;
    if (!link.otherwise.is_null()) object["else"] = link.otherwise;
    if (link.line) object["line"] = *link.line;
    if (link.after > Duration{}) object["after"] = seconds(link.after);
    if (link.lasts > Duration{}) object["for"] = seconds(link.lasts);
    if (link.between)
        object["between"] = time_text(link.between->first) + "-" + time_text(link.between->second);
    if (link.safe) object["safe"] = true;
    if (!link.enabled) object["disabled"] = true;
    if (!link.user.empty()) object["user"] = link.user;
    return object;
}

Expected<Link> read_link(const json& document) {
    std::string fault;
    text::JsonReader reader(document, "", fault);
    if (!reader.ok()) return fail(fault);
    Link link;
    for (const auto* key : {"name", "from", "to"})
        reader.required(key);
    link.name = reader.text("name");
    const auto from = reader.text("from", {}, kMaxIdBytes);
    link.board = from.substr(0, from.find('/'));
    link.source = from.size() > link.board.size() ? from.substr(link.board.size() + 1) : std::string();
    link.target = reader.text("to", {}, kMaxIdBytes);
    read_condition(reader, link);
    if (const auto* command = reader.find("command"); command != nullptr) {
        link.command = *command;
        // More would be read as its envelope: an id makes the second one a repetition.
        if (!command->is_object() || command->size() != 1)
            reader.fault("command", "must be an object with one command, such as {\"play\":[440,200]}");
    }
    read_value(reader, "value", link.value);
    read_value(reader, "else", link.otherwise);
    read_line(reader, link);
    link.after = duration(reader.number("after", 0, 0, kLongest));
    link.lasts = duration(reader.number("for", 0, 0, kLongest));
    if (const auto text = reader.text("between"); !text.empty()) {
        const auto between = parse_between(text);
        between ? void(link.between = *between) : reader.fault("between", between.error());
    }
    link.safe = reader.flag("safe");
    link.enabled = !reader.flag("disabled");
    link.user = reader.text("user", {}, model::kMaxNameBytes);
    reader.refuse_others();
    if (reader.ok()) check(reader, link);
    if (reader.ok() && model::dump_json(to_json(link)).size() > kMaxLinkBytes)
        reader.fault("", "is too long");
    if (!reader.ok()) return fail(fault);
    return link;
}

std::optional<bool> on_of(const json& value) {
    const json* on = &value;
    if (value.is_object())
        if (const auto found = value.find("on"); found != value.end()) on = &*found;
    return on->is_boolean() ? std::optional(on->get<bool>()) : std::nullopt;
}

std::string words_of(const json& value) {
    if (const auto on = on_of(value)) return *on ? "on" : "off";
    return value.is_string() ? value.get<std::string>() : model::dump_json(value);
}

std::string in_words(const Link& link) {
    auto text = link.board + "/" + link.source;
    const auto target =
        link.command.is_null() ? link.target : model::dump_json(link.command) + " to " + link.target;
    switch (link.when) {
        case When::kFollows:
            text = target + " follows " + text;
            if (link.line)
                text += " (" + words_of((*link.line)[0]) + ".." + words_of((*link.line)[1]) + " is " +
                        words_of((*link.line)[2]) + ".." + words_of((*link.line)[3]) + ")";
            break;
        case When::kInverted:
            text = target + " is the opposite of " + text;
            break;
        case When::kAbove:
        case When::kBelow:
            text = target + " while " + text + " is " + std::string(to_text(link.when)) + " " +
                   words_of(property::json_number(*link.level));
            if (link.back) text += " (until " + words_of(property::json_number(*link.back)) + ")";
            break;
        case When::kToggles:
            text = "each press of " + text + " switches " + target;
            break;
        default:
            text = target + " at each " + std::string(to_text(link.when)) + " of " + text;
    }
    if (!link.value.is_null()) text += ", " + words_of(link.value);
    if (!link.otherwise.is_null()) text += ", else " + words_of(link.otherwise);
    if (link.after > Duration{})
        text += ", after " + words_of(property::json_number(seconds(link.after))) + " s";
    if (link.lasts > Duration{})
        text += ", for " + words_of(property::json_number(seconds(link.lasts))) + " s";
    if (link.between) text += ", " + time_text(link.between->first) + "-" + time_text(link.between->second);
    return text;
}

std::string target_fault(const Link& link, const std::vector<Property>& properties) {
    if (!link.command.is_null()) return {};
    const auto* target = find(properties, link.target);
    if (target == nullptr) return not_there(link.target, properties, true);
    if (!target->settable()) return link.target + " cannot be set: it is only read";
    if (!target->refused.empty()) return target->refused;
    std::vector<json> values;
    if (!link.value.is_null()) values.push_back(link.value);
    if (!link.otherwise.is_null()) values.push_back(link.otherwise);
    if (link.line) values = {(*link.line)[2], (*link.line)[3]};
    const bool from_number = link.when == When::kFollows && link.value.is_null();
    if (values.empty() && !two_states(*target) && !from_number)
        return link.target + " is neither on nor off: say which value it gets";
    for (const auto& value : values)
        if (property::requests_for(*target, property::value_of_control(*target, value)).empty())
            return link.target + " cannot be " + text::printable(words_of(value), 64);
    return {};
}

std::string source_fault(const Link& link, const std::vector<Property>& properties) {
    const auto* source = find(properties, link.source);
    if (source == nullptr) return "of " + link.board + " " + not_there(link.source, properties, false);
    const auto name = link.board + "/" + link.source;
    const bool level = link.when == When::kAbove || link.when == When::kBelow || link.line;
    if (level && !is_number(*source)) return name + " is no number";
    if (!level && !two_states(*source) &&
        !(link.when == When::kFollows && link.value.is_null() && is_number(*source)))
        return name + " is neither on nor off: say above or below which level";
    if ((link.when == When::kHold || link.when == When::kDouble) && !property::is_button(*source))
        return name + " is no button: asipctl label " + name + " class=button makes it one";
    return {};
}

std::string circle(const std::vector<Ends>& links, const Ends& added) {
    // Forward from the new target, to the new source; `next` leads back.
    std::map<std::string, std::string> next{{added.second, ""}};
    std::vector<std::string> look{added.second};
    while (!look.empty()) {
        const auto at = look.back();
        look.pop_back();
        if (at == added.first) {
            std::string text = at;
            for (auto step = next[at]; !step.empty(); step = next[step])
                text = step + ", " + text;
            return text == at ? at + ", " + at : added.first + ", " + text;
        }
        for (const auto& [from, to] : links)
            if (from == at && next.emplace(to, at).second) look.push_back(to);
    }
    return {};
}

}  // namespace asip::links
