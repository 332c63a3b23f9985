// SPDX-License-Identifier: Apache-2.0
#include "asip/property/property_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "asip/model/names.hpp"
#include "asip/text/printable.hpp"

namespace asip::property {
namespace {

using nlohmann::json;
using text::JsonReader;

constexpr std::size_t kMaxChoices = 64;
constexpr std::size_t kMaxArguments = 16;
constexpr std::string_view kWhole = "integer";

constexpr std::pair<Kind, const char*> kKinds[] = {{Kind::kSensor, "sensor"}, {Kind::kBinarySensor, "binary"},
                                                   {Kind::kSwitch, "switch"}, {Kind::kNumber, "number"},
                                                   {Kind::kLight, "light"},   {Kind::kButton, "button"},
                                                   {Kind::kText, "text"},     {Kind::kSelect, "select"}};

using Choices = std::vector<std::pair<std::string, double>>;

// --- what is so where a list does not say it

/// "Servo 0 angle" of servo/0/angle.
std::string usual_name(std::string name) {
    std::replace_if(name.begin(), name.end(), [](char c) { return std::strchr("/-_.", c) != nullptr; }, ' ');
    if (!name.empty() && name[0] >= 'a' && name[0] <= 'z') name[0] = static_cast<char>(name[0] - 'a' + 'A');
    return name;
}

Kind usual_kind(bool settable) {
    return settable ? Kind::kNumber : Kind::kSensor;
}

Choices usual_choices(Kind kind) {
    const bool two = kind == Kind::kSwitch || kind == Kind::kBinarySensor;
    return two ? Choices{{"off", 0}, {"on", 1}} : Choices();
}

/// The place of a property that is only read.
std::string usual_place(const Property& property) {
    const bool read_only = property.kind == Kind::kSensor || property.kind == Kind::kBinarySensor;
    return read_only && !property.settable() ? "/" + property.id : std::string();
}

bool is_plain_number(const Property& property) {
    return (property.kind == Kind::kSensor || property.kind == Kind::kNumber) && property.choices.empty() &&
           property.max_length == 0;
}

// --- writing

void put_text(json& object, const char* key, const std::string& text) {
    if (!text.empty()) object[key] = text;
}

void put_number(json& object, const char* key, const std::optional<double>& number) {
    if (number) object[key] = json_number(*number);
}

void put_call(json& object, const char* key, const std::optional<Call>& call) {
    if (!call) return;
    auto& written = object[key] = json::array({call->command});
    for (const auto& argument : call->arguments)
        written.push_back(argument ? json_number(*argument) : json());
}

// --- reading

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

/// ["write",0,null]
std::optional<Call> read_call(JsonReader& reader, const char* key, const std::string& service) {
    const auto* list = reader.find(key);
    if (list == nullptr) return std::nullopt;
    const bool good =
        list->is_array() && !list->empty() && list->size() <= kMaxArguments + 1 && list->front().is_string();
    if (!good) {
        reader.fault(key, "is no short list of a command and its arguments");
        return std::nullopt;
    }
    Call call{service, list->front().get<std::string>(), {}};
    if (call.command.size() > kMaxWordBytes || !text::is_showable(call.command))
        reader.fault(key, "has no good name");
    for (std::size_t i = 1; i < list->size(); ++i) {
        const auto& argument = (*list)[i];
        if (argument.is_null())
            call.arguments.emplace_back();
        else if (argument.is_number())
            call.arguments.emplace_back(argument.get<double>());
        else
            reader.fault(key, "holds neither numbers nor null");
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
    property.kind = usual_kind(property.settable());
    if (reader.has("kind")) {
        const auto word = read_word(reader, "kind");
        const auto* found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                         [&](const auto& each) { return each.second == word; });
        if (found == std::end(kKinds)) return reader.fault("kind", "is none that this program knows");
        property.kind = found->first;
    }
    const auto usual = usual_choices(property.kind);
    if (property.choices.empty()) property.choices = usual;
    if (!usual.empty() && property.choices.size() != usual.size()) reader.fault("choices", "are not two");
    if (property.kind == Kind::kText && property.max_length == 0) reader.fault("max_length", "is missing");
    property.whole = is_plain_number(property) && reader.text("type", kWhole, kMaxWordBytes) == kWhole;
}

}  // namespace

json to_json(const Property& property, Members members) {
    json object{{"id", property.id}};
    const bool all = members == Members::kAll;
    if (all || property.name != usual_name(property.id)) object["name"] = property.name;
    const auto type = type_of(property);
    if (all) object["service"] = property.service;
    if (all) object["access"] = access_of(property);
    if (all || (is_plain_number(property) && !property.whole)) object["type"] = type;
    for (const auto& [kind, word] : kKinds)
        if (kind == property.kind && (all || kind != usual_kind(property.settable()))) object["kind"] = word;
    put_text(object, "unit", property.unit);
    put_text(object, "quantity", property.quantity);
    put_number(object, "min", property.min);
    put_number(object, "max", property.max);
    put_number(object, "step", property.step);
    put_number(object, "none", property.none);
    if (property.max_length > 0) object["max_length"] = property.max_length;
    if (all || property.choices != usual_choices(property.kind))
        for (const auto& [word, number] : property.choices)
            object["choices"].push_back({word, json_number(number)});
    if (property.read) {
        if (all || property.read->pointer != usual_place(property)) object["read"] = property.read->pointer;
        if (property.read->sum) object["sum"] = true;
    }
    put_call(object, "write", property.write);
    put_call(object, "color", property.color);
    put_call(object, "before", property.before);
    put_text(object, "refused", property.refused);
    if (property.floating) object["floating"] = true;
    if (property.advanced) object["advanced"] = true;
    if (property.meaning != model::Meaning()) object["meaning"] = model::to_json(property.meaning);
    return object;
}

Property read_property(JsonReader& reader) {
    Property property;
    property.id = read_word(reader, "id", true);
    property.name = reader.has("name") ? read_word(reader, "name") : usual_name(property.id);
    property.service = reader.has("service") ? read_word(reader, "service") : service_of(property.id);
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
    read_choices(reader, property);
    property.write = read_call(reader, "write", property.service);
    property.color = read_call(reader, "color", property.service);
    property.before = read_call(reader, "before", property.service);
    read_kind(reader, property);
    auto pointer = reader.has("read") ? read_word(reader, "read") : usual_place(property);
    if (!pointer.empty()) {
        if (!pointer.starts_with('/')) reader.fault("read", "is no JSON pointer");
        property.read = Place{property.service, std::move(pointer), reader.flag("sum")};
    }
    if (!property.read && !property.settable()) reader.fault("read", "is missing, and so is write");
    property.refused = read_word(reader, "refused");
    property.floating = reader.flag("floating");
    property.advanced = reader.flag("advanced");
    if (auto meaning = reader.object("meaning")) property.meaning = model::read_meaning(*meaning);
    return property;
}

}  // namespace asip::property
