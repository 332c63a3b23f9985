// SPDX-License-Identifier: Apache-2.0
#include "asip/model/event_decoder.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "asip/protocol/body.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using Fields = std::vector<std::string_view>;

constexpr std::size_t kMaxIndex = 255;

std::string in_quotes(std::string_view text) {
    return "\"" + std::string(text) + "\"";
}

/// What sensors and the Arduino core's print() say where there is no value: `nan`, `inf`, `ovf`, nothing.
bool is_no_value(std::string_view text) {
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
    std::string word(text.substr(0, 9));
    std::transform(word.begin(), word.end(), word.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text.empty() || word == "nan" || word == "inf" || word == "infinity" || word == "ovf";
}

/// Boards of different make send 12, 12.5 or 1.25e1 for one quantity, so each number that is one passes. What
/// is no value, or no number that a reader of JSON could hold, is null.
Expected<json> read_value(const Field& field, std::string_view text) {
    if (field.type == ValueType::kText) return json(std::string(text));
    if (const auto integer = protocol::parse_integer(text)) return json(*integer);
    if (is_no_value(text)) return json();
    if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
    double number = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (end != text.data() + text.size() || fault == std::errc::invalid_argument)
        return fail(field.name + ": " + in_quotes(text) + " is not a number");
    if (fault != std::errc{} || !(number > -1e15 && number < 1e15)) return json();
    return json(number + 0.0);  // not -0
}

Expected<json> read_element(const EventModel& event, const Fields& values, std::size_t first) {
    if (event.fields.size() == 1) return read_value(event.fields.front(), values[first]);
    json element = json::object();
    for (std::size_t i = 0; i < event.fields.size(); ++i) {
        auto value = read_value(event.fields[i], values[first + i]);
        if (!value) return value;
        element[event.fields[i].name] = std::move(*value);
    }
    return element;
}

Expected<json> decode_elements(const EventModel& event, const protocol::Body& body) {
    json elements = json::array();
    for (std::size_t i = 0; i < body.items.size(); ++i) {
        const auto values =
            body.items[i].empty() ? Fields(event.fields.size()) : protocol::split_fields(body.items[i]);
        const bool indexed = values.size() == event.fields.size() + 1;
        if (!indexed && values.size() != event.fields.size()) {
            return fail(in_quotes(body.items[i]) + " has " + std::to_string(values.size()) + " fields, not " +
                        std::to_string(event.fields.size()));
        }
        std::size_t place = i;
        if (indexed) {
            const auto index = protocol::parse_integer(values.front());
            if (!index || *index < 0 || *index > static_cast<std::int64_t>(kMaxIndex))
                return fail(in_quotes(values.front()) + " is not an index");
            place = static_cast<std::size_t>(*index);
        }
        auto element = read_element(event, values, indexed ? 1 : 0);
        if (!element) return element;
        while (elements.size() <= place)
            elements.push_back(nullptr);
        elements[place] = std::move(*element);
    }
    return elements;
}

/// Fewer values than fields pass: older sensors report fewer axes.
Expected<json> decode_once(const EventModel& event, const Fields& items) {
    if (items.empty() || items.size() > event.fields.size()) {
        return fail("body has " + std::to_string(items.size()) + " values, not " +
                    std::to_string(event.fields.size()));
    }
    json object = json::object();
    for (std::size_t i = 0; i < items.size(); ++i) {
        auto value = read_value(event.fields[i], items[i]);
        if (!value) return value;
        object[event.fields[i].name] = std::move(*value);
    }
    return object;
}

Expected<json> decode_plain(const EventModel& event, std::string_view body) {
    if (body.empty() && event.fields.front().type != ValueType::kText) return fail("body is empty");
    const auto items = protocol::split_fields(body, ',');
    if (event.fields.size() > 1) return decode_once(event, items);
    if (items.size() != 1) return fail("body has " + std::to_string(items.size()) + " values, not 1");
    return read_value(event.fields.front(), items.front());
}

Expected<json> decode_map(const EventModel& event, const protocol::Body& body) {
    json object = json::object();
    for (std::size_t i = 0; i < body.items.size(); ++i) {
        const auto parts = protocol::split_fields(body.items[i]);
        if (parts.size() > 2) return fail(in_quotes(body.items[i]) + " is not KEY:VALUE");
        const auto key =
            parts.size() == 1 ? std::optional<std::int64_t>(i) : protocol::parse_integer(parts.front());
        if (!key || *key < 0 || *key > static_cast<std::int64_t>(kMaxIndex))
            return fail(in_quotes(parts.front()) + " is not a key");
        auto value = read_value(event.fields.front(), parts.back());
        if (!value) return value;
        object[std::to_string(*key)] = std::move(*value);
    }
    return object;
}

/// One port, `4,2A`, or a list of them, `2,{3:0,4:2A}`.
Expected<std::vector<protocol::PortState>> read_port_states(std::string_view body) {
    std::vector<protocol::PortState> states;
    if (body.find('{') == body.npos) {
        const auto state = protocol::parse_port_state(body);
        if (!state) return fail(state.error());
        states.push_back(*state);
        return states;
    }
    const auto list = protocol::PortMap::parse(body);
    if (!list) return fail(list.error());
    for (const auto& [port, levels] : list->positions())
        states.push_back({port, levels});
    return states;
}

Expected<json> decode_ports(std::string_view body, const DecodeContext& context) {
    if (context.ports == nullptr || context.ports->empty()) return fail("the board's port map is not known");
    const auto states = read_port_states(body);
    if (!states) return fail(states.error());
    json levels = json::object();
    for (const auto& state : *states) {
        for (const auto& level : context.ports->levels(state)) {
            const auto pin = static_cast<std::size_t>(level.pin);
            if (pin < context.modes.size() && !protocol::is_digital_input(context.modes[pin])) continue;
            levels[std::to_string(level.pin)] = level.high ? 1 : 0;
        }
    }
    return levels;
}

Expected<json> decode_port_map(std::string_view body) {
    const auto map = protocol::PortMap::parse(body);
    if (!map) return fail(map.error());
    json positions = json::array();
    for (const auto& position : map->positions())
        positions.push_back({{"port", position.port}, {"mask", position.mask}});
    return positions;
}

Expected<json> decode_body(const EventModel& event, std::string_view text, const DecodeContext& context) {
    switch (event.shape) {
        case EventShape::kPlain:
            return decode_plain(event, text);
        case EventShape::kPorts:
            return decode_ports(text, context);
        case EventShape::kPortMap:
            return decode_port_map(text);
        case EventShape::kPerElement:
        case EventShape::kOnce:
        case EventShape::kMap:
            break;
    }
    const auto body = protocol::parse_body(text);
    if (!body) return fail(body.error());
    if (event.shape == EventShape::kOnce) return decode_once(event, body->items);
    if (event.shape == EventShape::kMap) return decode_map(event, *body);
    return decode_elements(event, *body);
}

}  // namespace

Expected<nlohmann::json> decode_event(const ServiceModel& model, const protocol::Event& event,
                                      const DecodeContext& context) {
    const auto* known = model.event(event.tag);
    if (known == nullptr) return fail(model.name + " has no event '" + event.tag + "'");
    auto value = decode_body(*known, event.body, context);
    if (!value) return fail(known->name + ": " + value.error());
    json object = json::object();
    object[known->name] = std::move(*value);
    return object;
}

json raw_event(const protocol::Event& event) {
    json object = json::object();
    object["tag"] = std::string(1, event.tag);
    object["body"] = std::string(event.body);
    return object;
}

}  // namespace asip::model
