// SPDX-License-Identifier: Apache-2.0
#include "asip/property/documents.hpp"

#include <cmath>
#include <limits>
#include <set>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/model/object_text.hpp"
#include "asip/property/property_json.hpp"
#include "asip/property/value.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/printable.hpp"

namespace asip::property {
namespace {

using model::ObjectText;
using nlohmann::json;
using text::JsonReader;

constexpr std::size_t kMaxEvents = 64;
constexpr double kMaxAge = 1e10;
constexpr std::size_t kAroundValues = 512;  // bytes of a document of values, beside them
constexpr std::size_t kUsualBytes = 64;     // of a value

void put_head(ObjectText& object, const DocumentHead& head) {
    object.add_number("version", kDocumentVersion);
    object.add("board", head.board).add("session", head.session);
    object.add_number("seq", static_cast<double>(head.seq));
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

json properties_json(const std::vector<Property>& properties, Members members = Members::kNeeded) {
    auto list = json::array();
    for (const auto& property : properties)
        list.push_back(to_json(property, members));
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

void add_value(ObjectText& object, const json& value) {
    constexpr double kExact = 9e15;  // a whole number of JSON may be greater
    if (value.is_number() && std::abs(value.get<double>()) < kExact)
        object.add_number("value", value.get<double>());
    else
        object.add_json("value", model::dump_json(value));
}

void write(ObjectText object, const ShownValue& value, Members members) {
    object.add_number("age", std::floor(value.age * 1000) / 1000);
    if (!value.events.empty()) {
        auto events = json::array();
        for (const auto& [number, act] : value.events)
            events.push_back({number, to_text(act)});
        object.add_json("events", model::dump_json(events));
    }
    if (value.how == How::kNone) {
        if (members == Members::kAll || value.why != Unknown::kNever)
            object.add("unknown", to_text(value.why));
        return;
    }
    object.add("how", to_text(value.how));
    add_value(object, value.value);
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
    // Readers take an object for a light. One of a later version is nothing that they know.
    if (value != nullptr && value->is_object() && !is_light_value(*value)) shown.how = How::kNone;
    if (shown.how != How::kNone && value != nullptr) shown.value = *value;
    read_events(reader, shown.events);
    return shown;
}

}  // namespace

std::string to_text(const PropertyList& list, Members members) {
    std::string text;
    {
        ObjectText document(text);
        put_head(document, list.head);
        document.add_json("properties", model::dump_json(properties_json(list.properties, members)));
    }
    return text;
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

std::string to_text(const ValueDocument& document, Members members) {
    auto left_out = document.left_out;
    std::string text;
    text.reserve(kAroundValues + document.values.size() * kUsualBytes);
    {
        ObjectText object(text);
        put_head(object, document.head);
        if (!document.clock.empty()) object.add("clock", document.clock);
        if (document.restarts > 0) object.add_number("restarts", static_cast<double>(document.restarts));
        if (!document.pins.is_null()) object.add_json("pins", model::dump_json(document.pins));
        if (!document.properties.empty())
            object.add_json("properties", model::dump_json(properties_json(document.properties)));
        const auto around = text.size();
        {
            auto values = object.object("values");
            for (const auto& [id, value] : document.values) {
                const auto before = text.size();
                write(values.object(id), value, members);
                if (text.size() - around <= kMaxValuesBytes - kAroundValues) continue;
                text.resize(before);
                ++left_out;
            }
        }
        if (left_out > 0) object.add_number("left_out", static_cast<double>(left_out));
    }
    return text;
}

std::vector<std::pair<std::string, ButtonAct>> new_acts(
    const std::map<std::string, ShownValue, std::less<>>& values, std::uint64_t& last) {
    std::map<std::uint64_t, std::pair<std::string, ButtonAct>> by_number;
    for (const auto& [id, value] : values)
        for (const auto& [number, act] : value.events)
            if (number > last) by_number.emplace(number, std::pair(id, act));
    std::vector<std::pair<std::string, ButtonAct>> result;
    for (auto& [number, act] : by_number) {
        last = number;
        result.push_back(std::move(act));
    }
    return result;
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
    result.restarts = static_cast<std::uint64_t>(
        reader.integer("restarts", 0, std::numeric_limits<std::int64_t>::max()).value_or(0));
    result.left_out = reader.integer("left_out", 0, kMaxProperties).value_or(0);
    if (reader.ok()) result.properties = read_properties(reader);
    if (reader.object("pins")) result.pins = (*document)["pins"];
    reader.required("values");
    for (auto& [id, each] : reader.ok() ? reader.members("values") : decltype(reader.members("values"))()) {
        if (result.values.size() >= kMaxProperties) reader.fault("values", "has too many members");
        if (id.size() > kMaxWordBytes || !text::is_showable(id)) reader.fault("values", "has what is no id");
        if (!reader.ok()) break;
        result.values[id] = read_value(each);
    }
    if (!reader.ok()) return fail(fault);
    return result;
}

}  // namespace asip::property
