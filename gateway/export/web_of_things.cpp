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

/// A form of MQTT: topics stand in the address, and in the words of the vocabulary.
json mqtt_form(const Forms& forms, const std::string& topic, json operations, bool publish) {
    json form{{"href", forms.broker + "/" + topic},
              {"op", std::move(operations)},
              {"contentType", kJson},
              {"security", json::array({"broker"})},
              {"mqv:controlPacket", publish ? "publish" : "subscribe"},
              {publish ? "mqv:topic" : "mqv:filter", topic},
              {"mqv:qos", publish ? "1" : "0"}};
    if (publish) form["mqv:retain"] = false;
    return form;
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
    if (!forms.broker.empty()) schemes["broker"] = {{"scheme", forms.broker_password ? "basic" : "nosec"}};
}

json page_parameters() {
    return {{"offset", {{"type", "integer"}, {"minimum", 0}}},
            {"limit", {{"type", "integer"}, {"minimum", 1}}}};
}

}  // namespace

std::string WebOfThings::thing_id(std::string_view board) const {
    return "urn:asip:" + escaped(options_.root) + ":" + std::string(board);
}

std::string WebOfThings::board_of(const std::string& id) const {
    const auto begin = thing_id("");
    return id.starts_with(begin) ? id.substr(begin.size()) : id;
}

/// A property, or the action of a button.
json WebOfThings::described(const ExportedBoard& board, const Property& property, const Forms& forms) const {
    const bool mqtt = !forms.broker.empty();
    const auto address = "things/" + board.board;
    const auto id = property::plain_id(property.id);
    const auto value_topic = state(board.board, property);
    const bool set_by_mqtt = mqtt && property.settable() && !options_.read_only;
    json result{{"title", property.name}};
    if (!property.meaning.klass.empty()) result["description"] = property.meaning.klass;
    auto& all = result["forms"] = json::array();
    if (property.kind == Kind::kButton) {
        auto form = http_form(address + "/actions/" + id, "invokeaction");
        // Without an input consumers would leave it out.
        form["htv:headers"] = {{{"htv:fieldName", "Content-Type"}, {"htv:fieldValue", kJson}}};
        if (forms.may_set) all.push_back(std::move(form));
        if (set_by_mqtt) all.push_back(mqtt_form(forms, value_topic + "/set", "invokeaction", true));
        return result;
    }
    const bool set_by_http = forms.may_set && property.settable();
    result.update(schema_of(property));
    result["observable"] = true;
    result["readOnly"] = !set_by_http && !set_by_mqtt;
    const auto place = address + "/properties/" + id;
    auto operations = json::array({"readproperty"});
    if (set_by_http) operations.push_back("writeproperty");
    all = {http_form(place, std::move(operations)),
           stream_form(place + "/stream", {"observeproperty", "unobserveproperty"})};
    if (mqtt) {
        auto form =
            mqtt_form(forms, value_topic, {"readproperty", "observeproperty", "unobserveproperty"}, false);
        form["mqv:retain"] = true;
        all.push_back(std::move(form));
    }
    if (set_by_mqtt) all.push_back(mqtt_form(forms, value_topic + "/set", "writeproperty", true));
    return result;
}

void WebOfThings::describe_states(json& thing, const ExportedBoard& board, const Forms& forms) const {
    const bool mqtt = !forms.broker.empty();
    const auto address = "things/" + board.board;
    auto& properties = thing["properties"];
    json state{
        {"title", "State of the board"},
        {"type", "string"},
        {"enum", {"online", "sleeping", "updating", "offline", "lost"}},
        {"readOnly", true},
        {"observable", mqtt},
        {"forms",
         json::array({http_form(address + "/properties/" + std::string(kBoardState), "readproperty")})}};
    if (mqtt) {
        const json operations{"readproperty", "observeproperty", "unobserveproperty"};
        state["forms"].push_back(mqtt_form(forms, board_state(board.board), operations, false));
        properties[std::string(kGatewayState)] = {
            {"title", "State of the gateway"},
            {"type", "string"},
            {"enum", {"online", "offline"}},
            {"readOnly", true},
            {"observable", true},
            {"forms", json::array({mqtt_form(forms, gateway_state(), operations, false)})}};
        if (!options_.read_only)
            thing["events"][std::string(kFailed)] = {
                {"title", "A command over MQTT failed"},
                {"data", {{"type", "string"}}},
                {"forms", json::array({mqtt_form(forms, error(board.board),
                                                 {"subscribeevent", "unsubscribeevent"}, false)})}};
    }
    properties[std::string(kBoardState)] = std::move(state);
}

json WebOfThings::thing(const ExportedBoard& board, const Forms& forms) const {
    json thing{
        {"@context",
         {kContext, {{"htv", "http://www.w3.org/2011/http#"}, {"mqv", "https://www.w3.org/2019/wot/mqtt#"}}}},
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
        else if (auto action = described(board, property, forms); !action["forms"].empty())
            actions[id] = std::move(action);
    }
    describe_states(thing, board, forms);
    thing["forms"] = json::array({http_form(address + "/properties", "readallproperties")});
    if (!actions.empty()) thing["actions"] = std::move(actions);
    return thing;
}

json WebOfThings::directory(const Forms& forms) const {
    json thing{{"@context", {kContext, kDirectoryContext}},
               {"@type", "ThingDirectory"},
               {"id", "urn:asip:" + escaped(options_.root)},
               {"title", "Boards of an ASIP service bus"},
               {"base", forms.base}};
    auto alone = forms;
    alone.broker.clear();
    describe_security(thing, alone);
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

std::string WebOfThings::state_of_board(bool there, std::string_view state) const {
    return model::dump_json(
        json(state.empty() ? std::string(there ? "online" : "offline") : std::string(state)));
}

std::string WebOfThings::state_text(const Property& /*property*/, const json& value) const {
    return value.is_null() ? std::string() : model::dump_json(value);
}

std::string WebOfThings::error_text(const std::string& sentence) const {
    return model::dump_json(json(sentence));
}

std::optional<Dialect::Command> WebOfThings::command_of(std::string_view topic) const {
    return command_below(base() + "/", topic);
}

Expected<json> WebOfThings::value_of(const Property& property, std::string_view payload) const {
    if (options_.read_only) return fail("this export is read-only");
    json value;
    const bool button = property.kind == Kind::kButton;
    if (!button) {
        const auto parsed =
            model::parse_json(payload, {.max_bytes = kMaxCommandBytes, .max_depth = kMaxCommandDepth});
        if (parsed) value = *parsed;
    }
    if (!property.settable()) return fail(property.name + " cannot be set");
    if ((!button && value.is_null()) || requests_for(property, value).empty())
        return not_taken(property, payload);
    return value;
}

}  // namespace asip::gateway::exports
