// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/web_of_things.hpp"

#include <cctype>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;
using Forms = WebOfThings::Forms;

constexpr const char* kContext = "https://www.w3.org/2022/wot/td/v1.1";
constexpr const char* kDirectoryContext = "https://www.w3.org/2022/wot/discovery";
constexpr const char* kJson = "application/json";
constexpr const char* kTd = "application/td+json";

/// What an URN may hold.
std::string escaped(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80 && (std::isalnum(byte) != 0 || std::string_view("-._~").find(c) != std::string::npos))
            result += c;
        else
            result.append("%").append(1, kDigits[byte >> 4]).append(1, kDigits[byte & 15]);
    }
    return result;
}

json words_of(const Property& property) {
    auto words = json::array();
    for (const auto& [word, value] : property.choices)
        words.push_back(word);
    return words;
}

json number_schema(const Property& property) {
    json schema{{"type", property.whole ? "integer" : "number"}};
    if (!property.unit.empty()) schema["unit"] = property.unit;
    if (property.min) schema["minimum"] = json_number(*property.min);
    if (property.max) schema["maximum"] = json_number(*property.max);
    if (property.whole && property.step && *property.step > 1)
        schema["multipleOf"] = json_number(*property.step);
    return schema;
}

json light_schema(const Property& property) {
    json members{{"on", {{"type", "boolean"}}}};
    if (has_brightness(property))
        members["brightness"] = {
            {"type", "integer"}, {"minimum", 0}, {"maximum", json_number(kFullBrightness)}};
    if (property.color)
        members["color"] = {{"type", "integer"},
                            {"minimum", 0},
                            {"maximum", json_number(kMaxColor)},
                            {"description", "Red, green and blue: 0xrrggbb"}};
    return {{"type", "object"}, {"properties", std::move(members)}, {"required", {"on"}}};
}

json schema_of(const Property& property) {
    switch (property.kind) {
        case Kind::kBinarySensor:
        case Kind::kSwitch:
            return {{"type", "boolean"}};
        case Kind::kLight:
            return light_schema(property);
        case Kind::kText:
            return {{"type", "string"}, {"maxLength", property.max_length}};
        case Kind::kSelect:
            return {{"type", "string"}, {"enum", words_of(property)}};
        case Kind::kSensor:
            if (property.max_length > 0) return {{"type", "string"}};
            if (!property.choices.empty()) return {{"type", "string"}, {"enum", words_of(property)}};
            return number_schema(property);
        case Kind::kNumber:
        case Kind::kButton:
            break;
    }
    return number_schema(property);
}

json http_form(const std::string& address, json operations) {
    return {{"href", address}, {"op", std::move(operations)}, {"contentType", kJson}};
}

json stream_form(const std::string& address, json operations) {
    auto form = http_form(address, std::move(operations));
    form["subprotocol"] = "sse";
    return form;
}

void describe_security(json& thing, const Forms& forms) {
    auto& schemes = thing["securityDefinitions"];
    if (forms.token)
        schemes["http"] = {{"scheme", "bearer"}, {"in", "header"}, {"name", "Authorization"}};
    else
        schemes["http"] = {{"scheme", "nosec"}};
    thing["security"] = json::array({"http"});
}

/// A property, or the action of a button; null: an action that the asker may not invoke.
json described(const ExportedBoard& board, const Property& property, const Forms& forms) {
    const auto address = "things/" + board.board;
    const auto id = property::plain_id(property.id);
    json result{{"title", property.name}};
    if (!property.meaning.klass.empty()) result["description"] = property.meaning.klass;
    if (property.kind == Kind::kButton) {
        if (!forms.may_set) return nullptr;
        auto form = http_form(address + "/actions/" + id, "invokeaction");
        // Without an input consumers would leave it out.
        form["htv:headers"] = {{{"htv:fieldName", "Content-Type"}, {"htv:fieldValue", kJson}}};
        result["forms"] = json::array({std::move(form)});
        return result;
    }
    const bool settable = forms.may_set && property.settable();
    result.update(schema_of(property));
    result["observable"] = true;
    result["readOnly"] = !settable;
    const auto place = address + "/properties/" + id;
    auto operations = json::array({"readproperty"});
    if (settable) operations.push_back("writeproperty");
    result["forms"] = {http_form(place, std::move(operations)),
                       stream_form(place + "/stream", {"observeproperty", "unobserveproperty"})};
    return result;
}

json state_of(const std::string& address) {
    return {{"title", "State of the board"},
            {"type", "string"},
            {"enum", {"online", "sleeping", "updating", "offline", "lost"}},
            {"readOnly", true},
            {"observable", false},
            {"forms", json::array({http_form(address + "/properties/" + std::string(WebOfThings::kBoardState),
                                             "readproperty")})}};
}

json page_parameters() {
    return {{"offset", {{"type", "integer"}, {"minimum", 0}}},
            {"limit", {{"type", "integer"}, {"minimum", 1}}}};
}

}  // namespace

std::string WebOfThings::thing_id(std::string_view board) const {
    return "urn:asip:" + escaped(root_) + ":" + std::string(board);
}

std::string WebOfThings::board_of(const std::string& id) const {
    const auto begin = thing_id("");
    return id.starts_with(begin) ? id.substr(begin.size()) : id;
}

json WebOfThings::thing(const ExportedBoard& board, const Forms& forms) const {
    json thing{{"@context", {kContext, {{"htv", "http://www.w3.org/2011/http#"}}}},
               {"@type", "Thing"},
               {"id", thing_id(board.board)},
               {"title", board.name.empty() ? board.board : board.name},
               {"base", forms.base}};
    if (!board.chip.empty())
        thing["description"] = board.sketch.empty() ? board.chip : board.sketch + " on " + board.chip;
    describe_security(thing, forms);
    const auto address = "things/" + board.board;
    auto& properties = thing["properties"] = json::object();
    auto actions = json::object();
    for (const auto& property : board.properties) {
        const auto id = property::plain_id(property.id);
        if (property.kind != Kind::kButton)
            properties[id] = described(board, property, forms);
        else if (auto action = described(board, property, forms); !action.is_null())
            actions[id] = std::move(action);
    }
    properties[std::string(kBoardState)] = state_of(address);
    thing["forms"] = json::array({http_form(address + "/properties", "readallproperties")});
    if (!actions.empty()) thing["actions"] = std::move(actions);
    return thing;
}

json WebOfThings::directory(const Forms& forms) const {
    json thing{{"@context", {kContext, kDirectoryContext}},
               {"@type", "ThingDirectory"},
               {"id", "urn:asip:" + escaped(root_)},
               {"title", "Boards of an ASIP service bus"},
               {"base", forms.base}};
    describe_security(thing, forms);
    thing["properties"]["things"] = {{"description", "The things that the asker may see, page by page"},
                                     {"uriVariables", page_parameters()},
                                     {"type", "array"},
                                     {"readOnly", true},
                                     {"forms",
                                      {{{"href", "things{?offset,limit}"},
                                        {"op", "readproperty"},
                                        {"contentType", "application/ld+json"}}}}};
    thing["actions"]["retrieveThing"] = {
        {"description", "One thing, by its id or the name of its board"},
        {"uriVariables", {{"id", {{"@type", "ThingID"}, {"type", "string"}}}}},
        {"output", {{"type", "object"}}},
        {"safe", true},
        {"idempotent", true},
        {"forms",
         {{{"href", "things/{id}"},
           {"op", "invokeaction"},
           {"htv:methodName", "GET"},
           {"response", {{"contentType", kTd}}}}}}};
    for (const std::string what : {"created", "updated", "deleted"}) {
        auto name = "thing" + what;
        name[5] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[5])));
        thing["events"][name] = {
            {"data", {{"type", "object"}, {"properties", {{"id", {{"type", "string"}}}}}}},
            {"forms", json::array({stream_form("events/thing_" + what, "subscribeevent")})}};
    }
    return thing;
}

}  // namespace asip::gateway::exports
