// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/homie.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/object_text.hpp"
#include "gateway/export/dialect.hpp"
#include "gateway/export/home_assistant.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

constexpr const char* kVersion = "5.0";
constexpr std::int64_t kMaxVersion = std::int64_t{1} << 53;  // of a description; exact in every reader of
                                                             // JSON
constexpr std::size_t kMaxDescriptionBytes = std::size_t{1} << 20;
constexpr int kMaxDescriptionDepth = 12;
constexpr int kChannels = 3;  // of a colour
const std::string kEmptyText(1, '\0');

bool is_id(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    });
}

/// `text` where it is an id without two hyphens, else with two of them and two hexadecimal digits in place of
/// each character that is no letter or digit: two names never become one.
std::string id_from(std::string_view text) {
    if (is_id(text) && text.find("--") == std::string_view::npos) return std::string(text);
    return escaped_id(text, "--", [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); });
}

json document_from(const std::string& text) {
    auto parsed =
        model::parse_json(text, {.max_bytes = kMaxDescriptionBytes, .max_depth = kMaxDescriptionDepth});
    return parsed && parsed->is_object() ? std::move(*parsed) : json();
}

/// The version in a description on the bus; 0: none of ours is there.
std::int64_t version_of(const std::string& description) {
    const auto document = description.empty() ? json() : document_from(description);
    const auto found = document.is_object() ? document.find("version") : document.end();
    if (found == document.end() || !found->is_number_integer()) return 0;
    const auto version = found->get<std::int64_t>();
    return version < 0 || version >= kMaxVersion ? 0 : version;
}

/// What `document` makes for a version larger than that of `on_bus`; `on_bus` where both say the same.
template <class Document>
std::string next_version(const Document& document, const std::string& on_bus) {
    const auto version = version_of(on_bus);
    if (!on_bus.empty() && document(version) == on_bus) return on_bus;
    return document(version + 1);
}

std::string number_text(double value) {
    return model::dump_json(json_number(value));
}

/// "0:180:5"; empty: no bounds.
std::string format_of_number(const Property& property) {
    if (!property.min && !property.max) return {};
    auto text = (property.min ? number_text(*property.min) : "") + ":" +
                (property.max ? number_text(*property.max) : "");
    if (property.step && *property.step > 0) text += ":" + number_text(*property.step);
    return text;
}

/// "a,b"; empty: they cannot be told apart so.
std::string format_of_words(const Property& property) {
    std::string text;
    for (const auto& [word, value] : property.choices) {
        if (word.empty() || word.find(',') != std::string::npos) return {};
        text += (text.empty() ? "" : ",") + word;
    }
    return text;
}

/// A light that is only on or off.
bool is_plain(const Property& light) {
    return !light.color && !has_brightness(light);
}

// A light has one value in this dialect: its colour, as bright as it is, or its brightness. Black is off.
std::string light_text(const Property& property, const json& value) {
    const bool on = value.value("on", false);
    const double brightness = on ? value.value("brightness", kFullBrightness) : 0;
    if (is_plain(property)) return on ? "true" : "false";
    if (!property.color) return number_text(brightness);
    const auto color = value.value("color", static_cast<std::uint32_t>(kMaxColor));
    std::string text = "rgb";
    for (int shift = 16; shift >= 0; shift -= 8) {
        const double part = color >> shift & 0xff;
        text += "," + number_text(on ? std::round(part * brightness / kFullBrightness) : 0);
    }
    return text;
}

/// "rgb,255,0,0"
std::optional<std::array<double, kChannels>> color_from(std::string_view text) {
    constexpr std::string_view kBegin = "rgb,";
    if (!text.starts_with(kBegin)) return std::nullopt;
    text.remove_prefix(kBegin.size());
    std::array<double, kChannels> parts{};
    for (int i = 0; i < kChannels; ++i) {
        const auto comma = text.find(',');
        if ((comma == std::string_view::npos) != (i == kChannels - 1)) return std::nullopt;
        const auto part = number_from(text.substr(0, comma));
        if (!part || *part < 0 || *part > kFullBrightness) return std::nullopt;
        parts[static_cast<std::size_t>(i)] = std::round(*part);
        text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
    return parts;
}

std::optional<json> light_from(const Property& property, std::string_view payload) {
    if (is_plain(property)) {
        if (payload != "true" && payload != "false") return std::nullopt;
        return json{{"on", payload == "true"}};
    }
    if (!property.color) {
        const auto level = number_from(payload);
        if (!level || *level < 0 || *level > kFullBrightness) return std::nullopt;
        return *level > 0 ? json{{"on", true}, {"brightness", json_number(std::round(*level))}}
                          : json{{"on", false}};
    }
    const auto parts = color_from(payload);
    if (!parts) return std::nullopt;
    const double brightest = *std::max_element(parts->begin(), parts->end());
    if (brightest == 0) return json{{"on", false}};
    json value{{"on", true}};
    std::uint32_t color = 0;
    for (const double part : *parts) {
        const double full = property.write ? std::round(part * kFullBrightness / brightest) : part;
        color = color << 8 | static_cast<std::uint32_t>(full);
    }
    value["color"] = color;
    if (property.write) value["brightness"] = json_number(brightest);
    return value;
}

void describe_value(ObjectText& described, const Property& property) {
    std::string type, format;
    switch (property.kind) {
        case Kind::kBinarySensor:
        case Kind::kSwitch:
            type = "boolean";
            break;
        case Kind::kButton:
            type = "enum";
            format = "press";
            described.add_bool("retained", false);
            break;
        case Kind::kText:
            type = "string";
            break;
        case Kind::kSelect:
            format = format_of_words(property);
            type = format.empty() ? "string" : "enum";
            break;
        case Kind::kLight:
            type = property.color ? "color" : is_plain(property) ? "boolean" : "integer";
            if (type != "boolean") format = property.color ? "rgb" : "0:" + number_text(kFullBrightness);
            break;
        case Kind::kSensor:
            format = format_of_words(property);
            if (property.max_length > 0 || (!property.choices.empty() && format.empty()))
                type = "string";
            else if (!format.empty())
                type = "enum";
            break;
        case Kind::kNumber:
            break;
    }
    if (type.empty()) {
        type = property.whole ? "integer" : "float";
        format = format_of_number(property);
        if (const auto unit = device_class_of(property.quantity, property.unit).unit; !unit.empty())
            described.add("unit", unit);
    }
    described.add("datatype", type);
    if (!format.empty()) described.add("format", format);
}

}  // namespace

bool Homie::valid_domain(std::string_view text) {
    return is_id(text);
}

std::string Homie::gateway_id() const {
    return id_from(options_.root);
}

std::string Homie::id_of(std::string_view board) const {
    return board == gateway_id() ? std::string(board) + "--" : id_from(board);
}

std::string Homie::name_of(std::string_view id) const {
    std::string name;
    while (!id.empty()) {
        const bool escaped = id.starts_with("--");
        unsigned byte = escaped ? 0 : static_cast<unsigned char>(id.front());
        id.remove_prefix(escaped ? 2 : 1);
        if (escaped) {
            const auto digits = id.substr(0, 2);
            id.remove_prefix(digits.size());
            if (std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16).ec != std::errc())
                break;
        }
        name += static_cast<char>(byte);
    }
    return name;
}

bool Homie::is_ours(const Retained& found, const std::string& topic, const std::string& place) const {
    if (topic.starts_with(base() + "/")) return true;
    const auto begin = place + "/5/";
    const auto slash = topic.starts_with(begin) ? topic.find('/', begin.size()) : std::string::npos;
    if (slash == std::string::npos) return false;
    const auto device = topic.substr(0, slash);
    if (device == begin + gateway_id()) return true;
    const auto description = found.find(device + "/" + std::string(kDescription));
    return description != found.end() &&
           description->second.find("\"root\":\"" + gateway_id() + "\"") != std::string::npos;
}

std::string Homie::gateway_document(const std::vector<std::string>& boards, const std::string& on_bus) const {
    std::vector<std::string> children;
    for (const auto& board : boards)
        children.push_back(id_of(board));
    const auto described = [&](std::int64_t version) {
        std::string text;
        {
            ObjectText object(text);
            object.add("homie", kVersion)
                .add_json("version", std::to_string(version))
                .add("name", "ASIP gateway")
                .add("type", "asip-gateway");
            if (!children.empty()) object.add_words("children", children);
        }
        return text;
    };
    return next_version(described, on_bus);
}

std::string Homie::document(const ExportedBoard& board, std::int64_t version) const {
    std::map<std::string, std::vector<const Property*>> nodes;
    for (const auto& property : board.properties)
        if (property.kind != Kind::kButton || !options_.read_only)
            nodes[property::plain_id(property.service)].push_back(&property);
    auto text = room_for(board.properties.size());
    {
        ObjectText object(text);
        object.add("homie", kVersion)
            .add_json("version", std::to_string(version))
            .add("name", board.name.empty() ? board.board : board.name)
            .add("type", "asip-board")
            .add("root", gateway_id());
        auto all = object.object("nodes");
        for (const auto& [id, properties] : nodes) {
            auto node = all.object(id);
            node.add("name", properties[0]->service);
            auto all_described = node.object("properties");
            for (const auto* property : properties) {
                auto described = all_described.object(property::plain_id(property->id));
                described.add("name", property->name).add_bool("settable", settable(*property));
                describe_value(described, *property);
            }
        }
    }
    return text;
}

Dialect::Document Homie::next_document(const ExportedBoard& board, const std::string& on_bus) const {
    return {next_version([&](std::int64_t version) { return document(board, version); }, on_bus), true};
}

std::string Homie::state_of_board(bool there, std::string_view state) const {
    if (state == "sleeping" || state == "lost") return std::string(state);
    return there ? "ready" : "disconnected";
}

std::string Homie::state(std::string_view board, const Property& property) const {
    return topic(id_of(board), property::plain_id(property.service) + "/" + property::plain_id(property.id));
}

std::string Homie::target(std::string_view board, const Property& property) const {
    if (!settable(property) || property.kind == Kind::kButton) return {};
    return state(board, property) + "/$target";
}

std::string Homie::state_text(const Property& property, const json& value) const {
    if (value.is_null()) return {};
    if (property.kind == Kind::kLight) return light_text(property, value);
    if (!value.is_string()) return model::dump_json(value);
    const auto& text = value.get_ref<const std::string&>();
    return text.empty() ? kEmptyText : text;
}

std::optional<Dialect::Command> Homie::command_of(std::string_view topic) const {
    const auto begin = options_.domain + "/5/";
    if (!topic.starts_with(begin)) return std::nullopt;
    topic.remove_prefix(begin.size());
    const auto slash = topic.find('/');
    if (slash == std::string_view::npos) return std::nullopt;
    auto command = command_below("", topic.substr(slash + 1));  // "NODE/PROPERTY/set"
    if (command) command->board = topic.substr(0, slash);
    return command;
}

Expected<json> Homie::value_of(const Property& property, std::string_view payload) const {
    if (options_.read_only) return fail("this export is read-only");
    if (!property.settable()) return fail(property.name + " cannot be set");
    std::optional<json> value;
    if (payload.size() <= kMaxCommandBytes) {
        switch (property.kind) {
            case Kind::kLight:
                value = light_from(property, payload);
                break;
            case Kind::kSwitch:
                if (payload == "true" || payload == "false") value = payload == "true";
                break;
            case Kind::kNumber:
                if (const auto wanted = number_from(payload)) value = json_number(*wanted);
                break;
            case Kind::kButton:
                if (payload == "press") value = json();
                break;
            default:
                value = payload == kEmptyText ? std::string() : std::string(payload);
        }
    }
    if (!value || requests_for(property, *value).empty()) return not_taken(property, payload);
    return *value;
}

}  // namespace asip::gateway::exports
