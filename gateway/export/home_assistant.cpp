// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/home_assistant.hpp"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <ranges>

#include "asip/model/json.hpp"
#include "asip/model/object_text.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

constexpr double kSmallestStep = 0.001;  // that Home Assistant takes
constexpr double kUsualStep = 0.01;
constexpr double kLargest = 2147483647;
constexpr std::size_t kMaxDocumentBytes = std::size_t{1} << 20;
constexpr int kMaxDocumentDepth = 8;

std::string color_mode(const Property& light) {
    if (light.color) return "rgb";
    return has_brightness(light) ? "brightness" : "onoff";
}

json light_state(const Property& property, const json& value) {
    json state{{"state", value.value("on", false) ? "ON" : "OFF"}};
    if (!value.value("on", false)) return state;
    state["color_mode"] = color_mode(property);
    if (has_brightness(property) && value.contains("brightness")) state["brightness"] = value["brightness"];
    if (value.contains("color")) {
        const auto color = value["color"].get<std::uint32_t>();
        state["color"] = {{"r", color >> 16 & 0xff}, {"g", color >> 8 & 0xff}, {"b", color & 0xff}};
    } else if (property.color) {
        state["color"] = {{"r", 255}, {"g", 255}, {"b", 255}};
    }
    return state;
}

/// 0 to 255.
std::optional<int> channel(const json& color, const char* name) {
    const auto found = color.find(name);
    if (found == color.end() || !found->is_number()) return std::nullopt;
    const auto value = found->get<double>();
    if (!(value >= 0 && value <= 255)) return std::nullopt;
    return static_cast<int>(value);
}

Expected<json> light_value(const Property& property, std::string_view payload) {
    const auto parsed =
        model::parse_json(payload, {.max_bytes = kMaxCommandBytes, .max_depth = kMaxCommandDepth});
    if (!parsed || !parsed->is_object()) return not_taken(property, payload);
    const auto state = parsed->find("state");
    if (state == parsed->end() || (*state != "ON" && *state != "OFF")) return not_taken(property, payload);
    json value{{"on", *state == "ON"}};
    if (const auto brightness = parsed->find("brightness"); brightness != parsed->end())
        value["brightness"] = *brightness;
    if (const auto color = parsed->find("color"); color != parsed->end()) {
        const auto r = channel(*color, "r"), g = channel(*color, "g"), b = channel(*color, "b");
        if (!r || !g || !b) return not_taken(property, payload);
        value["color"] = *r << 16 | *g << 8 | *b;
    }
    return value;
}

constexpr const char* kEvent = "event";

/// No other property has it: two hyphens stand in front of two hexadecimal digits in all other ids.
std::string event_id(const Property& property) {
    return property::plain_id(property.id) + "--event";
}

/// Home Assistant puts the name of the device in front.
void add_name(ObjectText& component, const ExportedBoard& board, const Property& property) {
    const auto& device = board.name.empty() ? board.board : board.name;
    if (property.name == device)
        component.add_json("name", "null");
    else if (property.name.starts_with(device + " "))
        component.add("name", property.name.substr(device.size() + 1));
    else
        component.add("name", property.name);
}

void describe_sensor(ObjectText& component, const Property& property) {
    if (!property.choices.empty()) {
        component.add("dev_cla", "enum").add_words("ops", std::views::keys(property.choices));
        return;
    }
    describe_unit(component, property);
    const auto what = quantity_of(property);
    // The mean of 359 and 1 degrees is not 180: a class for angles is younger than the oldest version.
    if (property.max_length == 0 && what != "angle")
        component.add("stat_cla", what == "energy" ? "total_increasing" : "measurement");
}

void describe_number(ObjectText& component, const Property& property) {
    describe_unit(component, property);
    const double min = property.min.value_or(-kLargest - 1);
    const double max = property.max.value_or(kLargest);
    const double step = std::max(property.step.value_or(property.whole ? 1 : kUsualStep), kSmallestStep);
    component.add_number("min", min)
        .add_number("max", max > min ? max : min + 1)  // some versions refuse a range of one value
        .add_number("step", step);
}

}  // namespace

bool HomeAssistant::shown(const Property& property) const {
    return !options_.read_only || property.kind != Kind::kButton;
}

std::string HomeAssistant::platform(const Property& property) const {
    switch (property.kind) {
        case Kind::kSensor:
            return "sensor";
        case Kind::kBinarySensor:
            return "binary_sensor";
        case Kind::kSwitch:
            return options_.read_only ? "binary_sensor" : "switch";
        case Kind::kLight:
            return options_.read_only ? "binary_sensor" : "light";
        case Kind::kNumber:
            return options_.read_only ? "sensor" : "number";
        case Kind::kText:
            return options_.read_only ? "sensor" : "text";
        case Kind::kSelect:
            return options_.read_only ? "sensor" : "select";
        case Kind::kButton:
            return "button";
    }
    return "sensor";
}

void HomeAssistant::describe_component(ObjectText& component, const ExportedBoard& board,
                                       const std::string& device, const Property& property) const {
    const auto kind = platform(property);
    const auto plain = property::plain_id(property.id);
    component.add("p", kind).add("uniq_id", device + "_" + plain);
    add_name(component, board, property);
    if (options_.entity_ids) {
        auto id = board.board + "_" + plain;
        for (char& c : id)
            c = std::isalnum(static_cast<unsigned char>(c)) != 0
                    ? static_cast<char>(std::tolower(static_cast<unsigned char>(c)))
                    : '_';
        component.add("def_ent_id", kind + "." + id);
    }
    if (property.hidden()) component.add_bool("en", false);
    describe_class(component, kind, property.meaning);
    const auto topic = state(board.board, plain);
    if (property.kind != Kind::kButton) component.add("stat_t", topic);
    if (property.settable() && !options_.read_only) component.add("cmd_t", topic + "/set");
    if (kind == "sensor") {
        describe_sensor(component, property);
    } else if (kind == "number") {
        describe_number(component, property);
    } else if (kind == "text") {
        component.add_number("max", static_cast<double>(std::min(property.max_length, kMaxStateBytes)))
            .add("pattern", "^[ -~]*$");
    } else if (kind == "select") {
        component.add_words("ops", std::views::keys(property.choices));
    } else if (kind == "light") {
        component.add("schema", "json").add_json("sup_clrm", "[\"" + color_mode(property) + "\"]");
        if (has_brightness(property)) component.add_bool("brightness", true);
    }
}

void HomeAssistant::describe_events(ObjectText& component, const ExportedBoard& board,
                                    const std::string& device, const Property& property) const {
    const auto id = event_id(property);
    component.add("p", kEvent).add("uniq_id", device + "_" + id).add("name", property.name + " events");
    if (property.hidden()) component.add_bool("en", false);
    component.add("dev_cla", "button")
        .add("stat_t", state(board.board, id))
        .add_words("evt_typ", property::button_words());
}

std::optional<Dialect::Act> HomeAssistant::act(std::string_view board, const Property& property,
                                               property::ButtonAct act) const {
    if (!property::is_button(property)) return std::nullopt;
    return Act{state(board, event_id(property)),
               R"({"event_type":")" + std::string(property::to_text(act)) + R"("})"};
}

void HomeAssistant::describe_device(ObjectText& document, const ExportedBoard& board,
                                    const std::string& id) const {
    {
        auto device = document.object("dev");
        device.add_json("ids", "[\"" + id + "\"]")
            .add("name", board.name.empty() ? board.board : board.name)
            .add("mf", "ASIP");
        if (!board.chip.empty()) device.add("mdl", board.chip);
        if (!board.sketch.empty()) device.add("sw", board.sketch);
        if (!board.room.empty()) device.add("sa", board.room);
        if (!options_.page.empty()) device.add("cu", options_.page + "#/board/" + board.board);
    }
    describe_origin(document);
    std::string available = "[";
    ObjectText(available).add("t", gateway_state());
    available += ',';
    ObjectText(available).add("t", board_state(board.board));
    available += ']';
    document.add_json("avty", available).add("avty_mode", "all");
}

HomeAssistant::Components HomeAssistant::components(const ExportedBoard& board) const {
    Components result;
    bool settable = false;
    for (const auto& property : board.properties) {
        if (shown(property)) result[property::plain_id(property.id)] = platform(property);
        if (property::is_button(property)) result[event_id(property)] = kEvent;
        settable = settable || property.settable();
    }
    if (settable && !options_.read_only) result[std::string(kLastError)] = "sensor";
    if (!firmware_text(board).empty()) result[std::string(kFirmware)] = "update";
    return result;
}

std::string HomeAssistant::document(const ExportedBoard& board, const Components& removed) const {
    const auto device = device_id(board.board);
    auto text = room_for(board.properties.size());
    {
        ObjectText document(text);
        describe_device(document, board, device);
        auto all = document.object("cmps");
        bool settable = false;
        for (const auto& property : board.properties) {
            settable = settable || property.settable();
            const auto id = property::plain_id(property.id);
            if (!shown(property) || removed.contains(id)) continue;
            auto component = all.object(id);
            describe_component(component, board, device, property);
        }
        for (const auto& property : board.properties) {
            if (!property::is_button(property) || removed.contains(event_id(property))) continue;
            auto component = all.object(event_id(property));
            describe_events(component, board, device, property);
        }
        const std::string error(kLastError);
        if (settable && !options_.read_only && !removed.contains(error) && board.property(error) == nullptr)
            all.object(error)
                .add("p", "sensor")
                .add("uniq_id", device + "_" + error)
                .add("name", "Last error")
                .add("ent_cat", "diagnostic")
                .add("stat_t", state(board.board, kLastError));
        if (!removed.contains(std::string(kFirmware))) describe_firmware(all, board);
        for (const auto& [id, platform] : removed)
            all.object(id).add("p", platform);
    }
    return text;
}

HomeAssistant::Components HomeAssistant::components_of(std::string_view document) {
    Components result;
    const auto parsed =
        model::parse_json(document, {.max_bytes = kMaxDocumentBytes, .max_depth = kMaxDocumentDepth});
    if (!parsed || !parsed->is_object()) return result;
    const auto components = parsed->find("cmps");
    if (components == parsed->end() || !components->is_object()) return result;
    for (const auto& [name, component] : components->items())
        if (component.is_object() && component.size() > 1 && component.contains("p") &&
            component["p"].is_string())
            result[name] = component["p"].get<std::string>();
    return result;
}

std::string HomeAssistant::removing_document(const ExportedBoard& board, const Components& old) const {
    const auto wanted = components(board);
    auto removed = old;
    std::erase_if(removed, [&](const auto& each) {
        const auto now = wanted.find(each.first);
        return now != wanted.end() && now->second == each.second;
    });
    return removed.empty() ? std::string() : document(board, removed);
}

// One that leaves components out does not remove them: they are named by their platform alone first.
Dialect::Document HomeAssistant::next_document(const ExportedBoard& board, const std::string& on_bus) const {
    if (on_bus.empty()) return {document(board), true};
    auto removing = removing_document(board, components_of(on_bus));
    if (removing.empty()) return {document(board), true};
    return {std::move(removing), false};
}

std::string HomeAssistant::state_text(const Property& property, const json& value) const {
    const bool light = property.kind == Kind::kLight && !options_.read_only;
    if (value.is_null()) {
        if (light) return R"({"state":null})";
        return property.kind == Kind::kText ? "" : "None";
    }
    if (property.kind == Kind::kLight) {
        if (options_.read_only) return value.value("on", false) ? "ON" : "OFF";
        return model::dump_json(light_state(property, value));
    }
    if (value.is_boolean()) return value.get<bool>() ? "ON" : "OFF";
    if (!value.is_string()) return model::dump_json(value);
    return cut(value.get<std::string>());
}

std::string HomeAssistant::cut(std::string text) {
    if (text.size() <= kMaxStateBytes) return text;
    auto end = kMaxStateBytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80)
        --end;  // not within a letter
    text.resize(end);
    return text;
}

std::optional<Dialect::Command> HomeAssistant::command_of(std::string_view topic) const {
    return command_below(base() + "/", topic);
}

Expected<json> HomeAssistant::value_of(const Property& property, std::string_view payload) const {
    if (options_.read_only) return fail("this export is read-only");
    json value;
    switch (property.kind) {
        case Kind::kLight: {
            auto light = light_value(property, payload);
            if (!light) return light;
            value = std::move(*light);
            break;
        }
        case Kind::kSwitch:
            if (payload != "ON" && payload != "OFF") return not_taken(property, payload);
            value = payload == "ON";
            break;
        case Kind::kNumber: {
            const auto wanted = number_from(payload);
            if (!wanted) return not_taken(property, payload);
            value = *wanted;
            break;
        }
        case Kind::kText:
        case Kind::kSelect:
            value = std::string(payload);
            break;
        case Kind::kButton:
            if (payload != "PRESS") return not_taken(property, payload);
            break;
        default:
            return fail(property.name + " cannot be set");
    }
    if (requests_for(property, value).empty()) return not_taken(property, payload);
    return value;
}

}  // namespace asip::gateway::exports
