// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/sparkplug.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"
#include "gateway/export/dialect.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;
using sparkplug::DataType;
using sparkplug::Metric;
using sparkplug::Value;

constexpr std::size_t kMaxIdBytes = 100;
constexpr std::size_t kMaxHostStateBytes = 4096;
constexpr std::string_view kNamespace = "spBv1.0/";
constexpr int kColorDigits = 6;
constexpr double kExact = 9e15;  // whole numbers up to here are exact

std::string color_text(std::uint32_t color) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text = "#";
    for (int shift = 4 * (kColorDigits - 1); shift >= 0; shift -= 4)
        text += kDigits[color >> shift & 15];
    return text;
}

/// "#ff0000"
std::optional<std::uint32_t> color_from_hex(std::string_view text) {
    if (text.size() != kColorDigits + 1 || text.front() != '#') return std::nullopt;
    std::uint32_t color = 0;
    const auto* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + 1, end, color, 16);
    if (error != std::errc() || rest != end) return std::nullopt;
    return color;
}

DataType data_type_of(const Property& property) {
    switch (property.kind) {
        case Kind::kBinarySensor:
        case Kind::kSwitch:
        case Kind::kButton:
            return DataType::kBoolean;
        case Kind::kText:
        case Kind::kSelect:
            return DataType::kString;
        default:
            if (property.max_length > 0 || !property.choices.empty()) return DataType::kString;
            return property.whole ? DataType::kInt64 : DataType::kDouble;
    }
}

Value part_of_light(Sparkplug::Part part, const json& value) {
    const auto on = value.find("on");
    if (on == value.end() || !on->is_boolean()) return {};
    if (part == Sparkplug::Part::kOn) return on->get<bool>();
    if (part == Sparkplug::Part::kBrightness && !on->get<bool>()) return std::int64_t{0};
    const auto found = value.find(part == Sparkplug::Part::kColor ? "color" : "brightness");
    if (found == value.end() || !found->is_number()) return {};
    if (part == Sparkplug::Part::kColor) return color_text(found->get<std::uint32_t>());
    return found->get<std::int64_t>();
}

std::optional<double> wanted_number(const Value& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
    if (const auto* real = std::get_if<double>(&value); real != nullptr && std::isfinite(*real)) return *real;
    return std::nullopt;
}

std::string wanted_text(const Value& value) {
    if (const auto* yes = std::get_if<bool>(&value)) return *yes ? "true" : "false";
    if (const auto* text = std::get_if<std::string>(&value)) return text::printable(*text, kShownBytes);
    if (const auto* real = std::get_if<double>(&value); real != nullptr && !std::isfinite(*real))
        return "no number";
    if (const auto number = wanted_number(value)) return json_number(*number).dump();
    return "nothing";
}

/// False: no such value.
bool add_to_light(json& light, const Sparkplug::Wanted& wanted) {
    switch (wanted.part) {
        case Sparkplug::Part::kOn: {
            const auto* on = std::get_if<bool>(&wanted.value);
            if (on == nullptr) return false;
            light["on"] = *on;
            return true;
        }
        case Sparkplug::Part::kBrightness: {
            const auto level = wanted_number(wanted.value);
            if (!level || *level < 0 || *level > kFullBrightness) return false;
            if (*level == 0 || !light.contains("on")) light["on"] = *level > 0;
            if (*level > 0) light["brightness"] = json_number(std::round(*level));
            return true;
        }
        case Sparkplug::Part::kColor: {
            const auto* text = std::get_if<std::string>(&wanted.value);
            const auto color = text != nullptr ? color_from_hex(*text) : std::nullopt;
            if (!color) return false;
            if (!light.contains("on")) light["on"] = true;
            light["color"] = *color;
            return true;
        }
        case Sparkplug::Part::kWhole:
            break;
    }
    return false;
}

std::optional<json> plain_value(const Property& property, const Value& wanted) {
    switch (property.kind) {
        case Kind::kSwitch:
        case Kind::kButton: {
            const auto* yes = std::get_if<bool>(&wanted);
            if (yes == nullptr || (property.kind == Kind::kButton && !*yes)) return std::nullopt;
            return property.kind == Kind::kButton ? json() : json(*yes);
        }
        case Kind::kText:
        case Kind::kSelect: {
            const auto* text = std::get_if<std::string>(&wanted);
            return text == nullptr ? std::nullopt : std::optional<json>(*text);
        }
        default: {
            const auto number = wanted_number(wanted);
            return number ? std::optional<json>(json_number(*number)) : std::nullopt;
        }
    }
}

Metric node_metric(std::string name, DataType type, Value value, std::uint64_t time_ms) {
    Metric metric;
    metric.name = std::move(name);
    metric.type = type;
    metric.timestamp = time_ms;
    metric.value = std::move(value);
    return metric;
}

}  // namespace

bool Sparkplug::valid_id(std::string_view text) {
    return !text.empty() && text.size() <= kMaxIdBytes && std::all_of(text.begin(), text.end(), [](char c) {
        return c > ' ' && c < 0x7f && c != '/' && c != '+' && c != '#';
    });
}

std::string Sparkplug::topic(std::string_view kind) const {
    return std::string(kNamespace) + options_.group + "/" + std::string(kind) + "/" + options_.edge;
}

std::string Sparkplug::topic(std::string_view kind, std::string_view board) const {
    return topic(kind) + "/" + std::string(board);
}

std::string Sparkplug::host_state() const {
    return std::string(kNamespace) + "STATE/" + options_.host;
}

std::optional<std::string> Sparkplug::board_of(std::string_view topic) const {
    const auto begin = this->topic("DCMD") + "/";
    if (!topic.starts_with(begin)) return std::nullopt;
    topic.remove_prefix(begin.size());
    if (topic.empty() || topic.find('/') != std::string_view::npos) return std::nullopt;
    return std::string(topic);
}

std::vector<Sparkplug::Slot> Sparkplug::slots(const Property& property) {
    if (property.kind != Kind::kLight) return {{property.id, Part::kWhole, data_type_of(property)}};
    std::vector<Slot> result{{property.id + "/on", Part::kOn, DataType::kBoolean}};
    if (has_brightness(property))
        result.push_back({property.id + "/brightness", Part::kBrightness, DataType::kInt64});
    if (property.color) result.push_back({property.id + "/color", Part::kColor, DataType::kString});
    return result;
}

Value Sparkplug::value(const Property& property, const Slot& slot, const json& value) {
    if (property.kind == Kind::kButton) return false;  // as that of Node Control/Rebirth
    if (slot.part != Part::kWhole) return part_of_light(slot.part, value);
    switch (slot.type) {
        case DataType::kBoolean:
            return value.is_boolean() ? Value(value.get<bool>()) : Value();
        case DataType::kInt64: {
            if (value.is_number_integer()) return value.get<std::int64_t>();
            if (!value.is_number() || !(std::abs(value.get<double>()) < kExact)) return {};
            return static_cast<std::int64_t>(std::round(value.get<double>()));
        }
        case DataType::kDouble:
            return value.is_number() ? Value(value.get<double>()) : Value();
        default:
            if (value.is_string()) return value.get<std::string>();
            // A number that has no word.
            return value.is_number() ? Value(model::dump_json(value)) : Value();
    }
}

std::vector<sparkplug::Property> Sparkplug::properties(const Property& property, const Slot& slot) const {
    std::vector<sparkplug::Property> result{{"name", property.name}};
    const bool number = slot.type == DataType::kInt64 || slot.type == DataType::kDouble;
    if (slot.part == Part::kBrightness) {
        result.push_back({"engLow", 0.0});
        result.push_back({"engHigh", kFullBrightness});
    } else if (number) {
        if (!property.unit.empty()) result.push_back({"engUnit", property.unit});
        if (property.min) result.push_back({"engLow", *property.min});
        if (property.max) result.push_back({"engHigh", *property.max});
    } else if (slot.type == DataType::kString && !property.choices.empty()) {
        std::string words;
        for (const auto& [word, each] : property.choices)
            words += (words.empty() ? "" : ",") + word;
        result.push_back({"options", std::move(words)});
    }
    if (!property.meaning.klass.empty()) result.push_back({"class", property.meaning.klass});
    result.push_back({"readOnly", !property.settable() || options_.read_only});
    return result;
}

std::optional<Sparkplug::HostState> Sparkplug::host_state_from(std::string_view payload) {
    const auto parsed = model::parse_json(payload, {.max_bytes = kMaxHostStateBytes, .max_depth = 4});
    if (!parsed || !parsed->is_object()) return std::nullopt;
    const auto online = parsed->find("online");
    const auto time = parsed->find("timestamp");
    if (online == parsed->end() || !online->is_boolean() || time == parsed->end() || !time->is_number())
        return std::nullopt;
    return HostState{online->get<bool>(), time->get<double>()};
}

Expected<json> Sparkplug::value_of(const Property& property, const std::vector<Wanted>& wanted,
                                   const json& known) const {
    if (options_.read_only) return fail("this export is read-only");
    if (!property.settable()) return fail(property.name + " cannot be set");
    std::optional<json> value;
    if (property.kind == Kind::kLight) {
        json light = json::object();
        bool good = !wanted.empty();
        for (const auto& each : wanted)
            good = good && add_to_light(light, each);
        // A light that gets another colour stays as bright as it is.
        if (good && light.value("on", false) && !light.contains("brightness") && known.is_object() &&
            known.value("on", false) && known.contains("brightness"))
            light["brightness"] = known["brightness"];
        if (good && light.contains("on")) value = std::move(light);
    } else if (!wanted.empty()) {
        value = plain_value(property, wanted.back().value);
    }
    if (!value || requests_for(property, *value).empty())
        return fail(property.name + " cannot be set to " +
                    (wanted.empty() ? std::string("nothing") : wanted_text(wanted.back().value)));
    return *value;
}

Metric Sparkplug::bd_seq(unsigned number, std::uint64_t time_ms) {
    return node_metric("bdSeq", DataType::kInt64, static_cast<std::int64_t>(number), time_ms);
}

std::vector<Metric> Sparkplug::node_metrics(unsigned bd_seq, std::uint64_t time_ms) const {
    std::vector<Metric> result{
        this->bd_seq(bd_seq, time_ms), node_metric(std::string(kRebirth), DataType::kBoolean, false, time_ms),
        node_metric("Properties/Software", DataType::kString, "asip-gateway", time_ms)};
    if (!options_.version.empty())
        result.push_back(node_metric("Properties/Version", DataType::kString, options_.version, time_ms));
    return result;
}

}  // namespace asip::gateway::exports
