// SPDX-License-Identifier: Apache-2.0
#include "asip/property/documents.hpp"

#include <cmath>
#include <limits>
#include <set>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/printable.hpp"

namespace asip::property {
namespace {

using nlohmann::json;
using text::JsonReader;

constexpr std::size_t kMaxWordBytes = 256;
constexpr std::size_t kMaxChoices = 64;
constexpr std::size_t kMaxArguments = 16;
constexpr std::size_t kMaxEvents = 64;
constexpr double kMaxAge = 1e10;
constexpr std::size_t kAroundValues = 512;  // bytes of a document of values, beside them

constexpr std::pair<Kind, const char*> kKinds[] = {{Kind::kSensor, "sensor"}, {Kind::kBinarySensor, "binary"},
                                                   {Kind::kSwitch, "switch"}, {Kind::kNumber, "number"},
                                                   {Kind::kLight, "light"},   {Kind::kButton, "button"},
                                                   {Kind::kText, "text"},     {Kind::kSelect, "select"}};

void put_head(json& object, const DocumentHead& head) {
    object["version"] = kDocumentVersion;
    object["board"] = head.board;
    object["session"] = head.session;
    object["seq"] = head.seq;
}

DocumentHead read_head(JsonReader& reader) {
    for (const auto* key : {"version", "board", "session", "seq"})
        reader.required(key);
    const auto version = reader.integer("version", 0, std::numeric_limits<std::int64_t>::max());
    if (version && *version != kDocumentVersion)
        reader.fault("version", "is " + std::to_string(*version) + "; this program knows " +
                                    std::to_string(kDocumentVersion));
    DocumentHead head;
    head.board = reader.text("board", {}, kMaxWordBytes);
    head.session = reader.text("session", {}, kMaxWordBytes);
    if (!model::valid_board_name(head.board)) reader.fault("board", "is not a valid name");
    if (!model::valid_name(head.session)) reader.fault("session", "is not a valid session");
    head.seq = reader.integer("seq", 0, std::numeric_limits<std::int64_t>::max()).value_or(0);
    return head;
}

// --- the list

void put_text(json& object, const char* key, const std::string& text) {
    if (!text.empty()) object[key] = text;
}

void put_number(json& object, const char* key, const std::optional<double>& number) {
    if (number) object[key] = json_number(*number);
}

void put_call(json& object, const char* key, const std::optional<Call>& call) {
    if (!call) return;
    auto arguments = json::array();
    for (const auto& argument : call->arguments)
        arguments.push_back(argument ? json_number(*argument) : json());
    object[key] = {{"command", call->command}, {"args", std::move(arguments)}};
}

json property_json(const Property& property) {
    json object{{"id", property.id},     {"name", property.name},     {"service", property.service},
                {"kind", std::string()}, {"type", type_of(property)}, {"access", access_of(property)}};
    for (const auto& [kind, word] : kKinds)
        if (kind == property.kind) object["kind"] = word;
    if (property.whole && type_of(property) != "integer") object["whole"] = true;
    put_text(object, "unit", property.unit);
    put_text(object, "quantity", property.quantity);
    put_number(object, "min", property.min);
    put_number(object, "max", property.max);
    put_number(object, "step", property.step);
    put_number(object, "none", property.none);
    if (property.max_length > 0) object["max_length"] = property.max_length;
    for (const auto& [word, number] : property.choices)
        object["choices"].push_back({word, json_number(number)});
    if (property.read) {
        object["read"] = property.read->pointer;
        if (property.read->sum) object["sum"] = true;
    }
    put_call(object, "write", property.write);
    put_call(object, "color", property.color);
    put_call(object, "before", property.before);
    put_text(object, "refused", property.refused);
    if (property.advanced) object["advanced"] = true;
    if (property.meaning != model::Meaning()) object["meaning"] = model::to_json(property.meaning);
    return object;
}

std::string read_word(JsonReader& reader, const char* key, bool needed = false) {
    if (needed) reader.required(key);
    auto word = reader.text(key, {}, kMaxWordBytes);
    if (!text::is_showable(word)) reader.fault(key, "holds control characters");
    return word;
}

std::optional<double> read_number(JsonReader& reader, const char* key) {
    const auto* member = reader.find(key);
    if (member == nullptr) return std::nullopt;
    const bool good = member->is_number() && std::isfinite(member->get<double>());
    if (!good) {
        reader.fault(key, "is not a number");
        return std::nullopt;
    }
    return member->get<double>();
}

std::optional<Call> read_call(JsonReader& reader, const char* key, const std::string& service) {
    auto object = reader.object(key);
    if (!object) return std::nullopt;
    Call call{service, read_word(*object, "command", true), {}};
    const auto* arguments = object->required("args");
    if (!reader.ok()) return std::nullopt;
    if (!arguments->is_array() || arguments->size() > kMaxArguments) {
        object->fault("args", "is not a short list");
        return std::nullopt;
    }
    for (const auto& argument : *arguments) {
        if (argument.is_null())
            call.arguments.emplace_back();
        else if (argument.is_number())
            call.arguments.emplace_back(argument.get<double>());
        else
            object->fault("args", "holds neither numbers nor null");
    }
    return call;
}

void read_choices(JsonReader& reader, Property& property) {
    const auto* list = reader.find("choices");
    if (list == nullptr) return;
    if (!list->is_array() || list->size() > kMaxChoices)
        return reader.fault("choices", "is not a short list");
    for (const auto& choice : *list) {
        const bool good = choice.is_array() && choice.size() == 2 && choice[0].is_string() &&
                          choice[1].is_number() && choice[0].get_ref<const std::string&>().size() < 64 &&
                          text::is_showable(choice[0].get_ref<const std::string&>());
        if (!good) return reader.fault("choices", "holds what is no [WORD, NUMBER]");
        property.choices.emplace_back(choice[0].get<std::string>(), choice[1].get<double>());
    }
}

void read_kind(JsonReader& reader, Property& property) {
    const auto word = read_word(reader, "kind", true);
    for (const auto& [kind, name] : kKinds)
        if (word == name) {
            property.kind = kind;
            const bool two = kind == Kind::kSwitch || kind == Kind::kBinarySensor;
            if (two && property.choices.size() != 2) reader.fault("choices", "are not two");
            if (kind == Kind::kText && property.max_length == 0) reader.fault("max_length", "is missing");
            return;
        }
    reader.fault("kind", "is none that this program knows");
}

Property read_property(JsonReader& reader) {
    Property property;
    property.id = read_word(reader, "id", true);
    property.name = read_word(reader, "name", true);
    property.service = read_word(reader, "service", true);
    if (!model::valid_name(property.service)) reader.fault("service", "is not a valid name");
    if (property.id != property.service && !property.id.starts_with(property.service + "/"))
        reader.fault("id", "is not below its service");
    property.unit = read_word(reader, "unit");
    property.quantity = read_word(reader, "quantity");
    property.min = read_number(reader, "min");
    property.max = read_number(reader, "max");
    property.step = read_number(reader, "step");
    property.none = read_number(reader, "none");
    property.max_length = reader.integer("max_length", 0, kMaxWordBytes).value_or(0);
    property.whole = reader.text("type", {}, kMaxWordBytes) == "integer" || reader.flag("whole");
    read_choices(reader, property);
    read_kind(reader, property);
    if (auto pointer = read_word(reader, "read"); !pointer.empty()) {
        if (!pointer.starts_with('/')) reader.fault("read", "is no JSON pointer");
        property.read = Place{property.service, std::move(pointer), reader.flag("sum")};
    }
    property.write = read_call(reader, "write", property.service);
    property.color = read_call(reader, "color", property.service);
    property.before = read_call(reader, "before", property.service);
    if (!property.read && !property.settable()) reader.fault("read", "is missing, and so is write");
    property.refused = read_word(reader, "refused");
    property.advanced = reader.flag("advanced");
    if (auto meaning = reader.object("meaning")) property.meaning = model::read_meaning(*meaning);
    return property;
}

json properties_json(const std::vector<Property>& properties) {
    auto list = json::array();
    for (const auto& property : properties)
        list.push_back(property_json(property));
    return list;
}

std::vector<Property> read_properties(JsonReader& reader) {
    std::vector<Property> properties;
    std::set<std::string> ids;
    for (auto& each : reader.list("properties", kMaxProperties)) {
        properties.push_back(read_property(each));
        if (reader.ok() && !ids.insert(properties.back().id).second) each.fault("id", "is there twice");
        if (!reader.ok()) break;
    }
    return properties;
}

// --- values

json value_json(const ShownValue& value) {
    json object{{"age", std::floor(value.age * 1000) / 1000}};
    if (value.how == How::kNone)
        object["unknown"] = to_text(value.why);
    else
        object["value"] = value.value;
    if (value.how != How::kNone) object["how"] = to_text(value.how);
    for (const auto& [number, act] : value.events)
        object["events"].push_back({number, to_text(act)});
    return object;
}

/// [[7,"press"],[8,"release"]]; words of later versions are passed over.
void read_events(JsonReader& reader, std::vector<ButtonEvent>& events) {
    const auto* list = reader.find("events");
    if (list == nullptr) return;
    if (!list->is_array() || list->size() > kMaxEvents) return reader.fault("events", "is not a short list");
    for (const auto& event : *list) {
        const bool good =
            event.is_array() && event.size() == 2 && event[0].is_number_unsigned() && event[1].is_string();
        if (!good) return reader.fault("events", "holds what is no [NUMBER, WORD]");
        if (const auto act = button_act(event[1].get_ref<const std::string&>()))
            events.push_back({event[0].get<std::uint64_t>(), *act});
    }
}

ShownValue read_value(JsonReader& reader) {
    ShownValue shown;
    shown.age = reader.number("age", 0, 0, kMaxAge);
    const auto how = reader.text("how", {}, kMaxWordBytes);
    const auto why = reader.text("unknown", {}, kMaxWordBytes);
    for (const auto each : {How::kReported, How::kAnswered, How::kSet})
        if (how == to_text(each)) shown.how = each;
    for (const auto each : {Unknown::kNever, Unknown::kRestart, Unknown::kDoubt})
        if (why == to_text(each)) shown.why = each;
    const auto* value = reader.find("value");
    if (shown.how != How::kNone && value == nullptr) reader.fault("value", "is missing");
    if (shown.how != How::kNone && value != nullptr) shown.value = *value;
    read_events(reader, shown.events);
    return shown;
}

}  // namespace

std::string to_text(const PropertyList& list) {
    json document = json::object();
    put_head(document, list.head);
    document["properties"] = properties_json(list.properties);
    return model::dump_json(document);
}

Expected<PropertyList> parse_list(std::string_view text) {
    const auto document = model::parse_json(text, {.max_bytes = kMaxListBytes, .max_depth = 8});
    if (!document) return fail("/: " + document.error());
    std::string fault;
    JsonReader reader(*document, "", fault);
    PropertyList list;
    list.head = read_head(reader);
    reader.required("properties");
    if (reader.ok()) list.properties = read_properties(reader);
    if (!reader.ok()) return fail(fault);
    return list;
}

ShownValue shown(const Known& known, Time now, std::vector<ButtonEvent> events) {
    const std::chrono::duration<double> age = now - known.since;
    return {known.value, known.how, known.why, std::max(age.count(), 0.0), std::move(events)};
}

ValueDocument values_of(const KnownValues& known, Time now) {
    return values_of(known, now, [](const std::string&) { return true; });
}

std::string to_text(const ValueDocument& document) {
    json object = json::object();
    put_head(object, document.head);
    if (!document.clock.empty()) object["clock"] = document.clock;
    auto left_out = document.left_out;
    std::string values;
    for (const auto& [id, value] : document.values) {
        auto written = model::dump_json(id) + ":" + model::dump_json(value_json(value));
        if (values.size() + written.size() > kMaxValuesBytes - kAroundValues)
            ++left_out;
        else
            values += (values.empty() ? "" : ",") + written;
    }
    if (!document.pins.is_null()) object["pins"] = document.pins;
    if (!document.properties.empty()) object["properties"] = properties_json(document.properties);
    if (left_out > 0) object["left_out"] = left_out;
    auto text = model::dump_json(object);
    text.back() = ',';
    return text + "\"values\":{" + values + "}}";
}

Expected<ValueDocument> parse_values(std::string_view text) {
    const auto document =
        model::parse_json(text, {.max_bytes = kMaxValuesBytes + kMaxListBytes, .max_depth = 8});
    if (!document) return fail("/: " + document.error());
    std::string fault;
    JsonReader reader(*document, "", fault);
    ValueDocument result;
    result.head = read_head(reader);
    result.clock = reader.text("clock", {}, kMaxWordBytes);
    result.left_out = reader.integer("left_out", 0, kMaxProperties).value_or(0);
    if (reader.ok()) result.properties = read_properties(reader);
    if (reader.object("pins")) result.pins = (*document)["pins"];
    reader.required("values");
    for (auto& [id, each] : reader.ok() ? reader.members("values") : decltype(reader.members("values"))()) {
        if (result.values.size() >= kMaxProperties) reader.fault("values", "has too many members");
        if (!reader.ok()) break;
        result.values[id] = read_value(each);
    }
    if (!reader.ok()) return fail(fault);
    return result;
}

}  // namespace asip::property
