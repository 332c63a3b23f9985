// SPDX-License-Identifier: Apache-2.0
#include "asip/model/labels.hpp"

#include <charconv>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using text::JsonReader;

constexpr std::string_view kPin = "pin.";
constexpr int kMaxSettableMode = 5;  // PWM

bool is_alphanumeric(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
}

bool is_utf8(std::string_view value) {
    const json text(value);
    const auto back = parse_json(dump_json(text));
    return back && *back == text;
}

std::string as_written(std::string_view value) {
    return "'" + text::printable(value) + "'";
}

std::optional<int> pin_number(std::string_view digits) {
    int pin = -1;
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), pin);
    const bool whole = read.ec == std::errc() && read.ptr == digits.data() + digits.size();
    const bool plain = digits.size() == 1 || !digits.starts_with('0');
    if (!whole || !plain || pin < 0 || pin > kMaxLabelledPin) return std::nullopt;
    return pin;
}

std::string explain_service(std::string_view name) {
    return valid_name(name) ? std::string() : as_written(name) + " is not the name of a service";
}

template <class Map>
std::string found(const Map& map, const typename Map::key_type& key) {
    const auto it = map.find(key);
    return it == map.end() ? std::string() : it->second;
}

template <class Map, class Changes>
void change_map(Map& map, const Changes& changes) {
    for (const auto& [key, value] : changes)
        if (value)
            map[key] = *value;
        else
            map.erase(key);
}

/// Each member of the object `key` of `reader`, judged; `take(name, value)`.
template <class Take>
void read_values(JsonReader& reader, const char* key, bool may_remove, std::size_t most,
                 std::string (*explain_key)(std::string_view), std::string (*explain_value)(std::string_view),
                 const Take& take) {
    auto members = reader.object(key);
    if (!members) return;
    if (members->value().size() > most)
        members->fault({}, "has more than " + std::to_string(most) + " members");
    for (const auto& [name, value] : members->value().items()) {
        if (const auto why = explain_key(name); !why.empty()) return members->fault(name, why);
        if (may_remove && value.is_null()) {
            take(name, LabelChange::Value());
            continue;
        }
        const auto written = members->text(name);
        if (const auto why = explain_value(written); !why.empty()) members->fault(name, why);
        if (!reader.ok()) return;
        take(name, LabelChange::Value(written));
    }
}

std::string explain_pin(std::string_view digits) {
    return pin_number(digits) ? std::string() : as_written(digits) + " is not a pin from 0 to 255";
}

LabelChange read_members(JsonReader& reader, bool may_remove) {
    LabelChange read;
    read_values(
        reader, "labels", may_remove, kMaxLabels, explain_label_key, explain_label_value,
        [&](const std::string& key, LabelChange::Value value) { read.labels[key] = std::move(value); });
    auto names = reader.object("names");
    if (!names) return read;
    read_values(
        *names, "services", may_remove, kMaxFriendlyNames, explain_service, explain_friendly_name,
        [&](const std::string& key, LabelChange::Value value) { read.services[key] = std::move(value); });
    read_values(*names, "pins", may_remove, kMaxFriendlyNames, explain_pin, explain_friendly_name,
                [&](const std::string& key, LabelChange::Value value) {
                    read.pins[*pin_number(key)] = std::move(value);
                });
    if (may_remove) names->refuse_others();
    return read;
}

std::map<int, int> read_modes(JsonReader& reader) {
    std::map<int, int> modes;
    auto members = reader.object("pin_modes");
    if (!members) return modes;
    for (const auto& [pin, value] : members->value().items()) {
        const auto number = pin_number(pin);
        if (!number) members->fault(pin, "is not a pin from 0 to 255");
        const auto mode = members->integer(pin, 0, kMaxSettableMode);
        if (!reader.ok()) return {};
        modes[*number] = static_cast<int>(mode.value_or(0));
    }
    return modes;
}

std::string bounds_fault(const Labels& labels) {
    if (labels.labels.size() > kMaxLabels)
        return "a board has at most " + std::to_string(kMaxLabels) + " labels; remove one first (KEY-)";
    if (labels.services.size() + labels.pins.size() > kMaxFriendlyNames)
        return "a board has at most " + std::to_string(kMaxFriendlyNames) +
               " names of services and pins; remove one first (pin.N-)";
    return {};
}

}  // namespace

std::string Labels::service(const std::string& name) const {
    return found(services, name);
}

std::string Labels::pin(int number) const {
    return found(pins, number);
}

std::string explain_label_key(std::string_view key) {
    if (key.empty()) return "the key of a label is empty; write KEY=VALUE";
    if (key.size() > kMaxLabelBytes)
        return as_written(key) + " is " + std::to_string(key.size()) + " bytes long; a key has at most 63";
    if (key.starts_with(kPin)) return as_written(key) + ": keys that begin with pin. are for names of pins";
    if (!valid_name(key) || !is_alphanumeric(key.front()) || !is_alphanumeric(key.back()))
        return as_written(key) +
               " is not a key: letters, digits and . _ - between them, such as room or floor-2";
    return {};
}

std::string explain_label_value(std::string_view value) {
    if (value.size() > kMaxLabelBytes)
        return "is " + std::to_string(value.size()) + " bytes long; at most 63 are allowed";
    if (!text::is_showable(value)) return "holds control characters";
    if (!is_utf8(value)) return "is not UTF-8";
    for (std::size_t at = 0; at < value.size(); ++at) {
        const auto rest = value.substr(at);
        const bool joins = rest.starts_with("\u200c") || rest.starts_with("\u200d");  // in scripts, in emoji
        if (text::begins_unseen(rest) && !joins) return "holds characters that no one sees";
    }
    if (value.starts_with(' ') || value.ends_with(' ')) return "begins or ends with a blank";
    return {};
}

std::string explain_friendly_name(std::string_view name) {
    return name.empty() ? "is empty" : explain_label_value(name);
}

Expected<void> add_assignment(LabelChange& change, std::string_view text, std::string_view service) {
    const auto equals = text.find('=');
    const bool removes = equals == std::string_view::npos && text.size() > 1 && text.ends_with('-');
    if (equals == std::string_view::npos && !removes)
        return fail(as_written(text) + ": write KEY=VALUE to set a label, or KEY- to remove it");
    auto key = text.substr(0, removes ? text.size() - 1 : equals);
    const auto value = removes ? LabelChange::Value() : LabelChange::Value(text.substr(equals + 1));
    if (const auto slash = key.find('/'); slash != std::string_view::npos && service.empty()) {
        service = key.substr(0, slash);
        key = key.substr(slash + 1);
        if (const auto why = explain_service(service); !why.empty()) return fail(why);
    }
    const bool label = service.empty() && !key.starts_with(kPin);
    if (value) {
        const auto why = label ? explain_label_value(*value) : explain_friendly_name(*value);
        if (!why.empty()) return fail("the value of " + text::printable(key) + " " + why);
    }
    if (!service.empty()) {
        if (key != "name")
            return fail(as_written(key) + ": of a service only its name can be given: name=\"left arm\"");
        change.services[std::string(service)] = value;
        return {};
    }
    if (label) {
        if (const auto why = explain_label_key(key); !why.empty()) return fail(why);
        change.labels[std::string(key)] = value;
        return {};
    }
    const auto pin = pin_number(key.substr(kPin.size()));
    if (!pin) return fail(as_written(key) + " is not a pin; write pin.13=\"status lamp\"");
    change.pins[*pin] = value;
    return {};
}

Expected<Labels> changed(Labels labels, const LabelChange& change) {
    change_map(labels.labels, change.labels);
    change_map(labels.services, change.services);
    change_map(labels.pins, change.pins);
    auto meanings = changed(std::move(labels.meanings), change.meanings);
    if (!meanings) return fail(meanings.error());
    labels.meanings = std::move(*meanings);
    if (const auto why = bounds_fault(labels); !why.empty()) return fail(why);
    return labels;
}

void put_labels(json& object, const Labels& labels) {
    if (!labels.labels.empty()) object["labels"] = labels.labels;
    if (!labels.services.empty()) object["names"]["services"] = labels.services;
    for (const auto& [pin, name] : labels.pins)
        object["names"]["pins"][std::to_string(pin)] = name;
    put_meanings(object, labels.meanings);
    for (const auto& [pin, mode] : labels.modes)
        object["pin_modes"][std::to_string(pin)] = mode;
}

Labels read_labels(JsonReader& reader) {
    auto labels = changed({}, read_members(reader, false));
    if (!labels) {
        reader.fault("names", labels.error());
        return {};
    }
    labels->meanings = read_meanings(reader);
    labels->modes = read_modes(reader);
    return std::move(*labels);
}

LabelChange read_label_change(JsonReader& reader) {
    auto change = read_members(reader, true);
    change.meanings = read_meaning_changes(reader);
    return change;
}

json to_json(const LabelChange& change) {
    json object = json::object();
    const auto put = [](json& into, const std::string& key, const LabelChange::Value& value) {
        into[key] = value ? json(*value) : json();
    };
    for (const auto& [key, value] : change.labels)
        put(object["labels"], key, value);
    for (const auto& [service, name] : change.services)
        put(object["names"]["services"], service, name);
    for (const auto& [pin, name] : change.pins)
        put(object["names"]["pins"], std::to_string(pin), name);
    for (const auto& [id, meaning] : change.meanings)
        object["meanings"][id] = meaning;
    return object;
}

}  // namespace asip::model
